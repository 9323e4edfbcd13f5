#include "rpc/durability/faults/reader.h"

#include <algorithm>

namespace lpv::rpc::faults {

Reader::Reader(std::string name, bool volumes, const Part& part)
    : name_(std::move(name)), part_(part), volumes_(volumes) {
  sceneThread_ = std::thread([this] {
    Dice dice(part_.seed);
    while (!stopping_) watchScene(dice);
  });
  if (!volumes_) return;
  volumeThread_ = std::thread([this] {
    Dice dice(part_.seed + 1);
    while (!stopping_) watchVolumes(dice);
  });
}

Reader::~Reader() { stop(); }

void Reader::stop() {
  stopping_ = true;
  if (sceneThread_.joinable()) sceneThread_.join();
  if (volumeThread_.joinable()) volumeThread_.join();
}

Position Reader::position() const {
  const std::lock_guard lock(mutex_);
  return volumes_ ? std::min(scenePosition_, volumePosition_) : scenePosition_;
}

void Reader::record(Read read, Position* position) {
  const std::lock_guard lock(mutex_);
  *position = {read.epoch, read.revision};
  reads_.push_back(std::move(read));
}

bool Reader::stays(Dice& dice) {
  if (calm_) return true;
  if (dice.once(60)) dice.pause(100, 1200);
  return !dice.once(150);
}

void Reader::watchScene(Dice& dice) {
  Stubs stubs(part_.proxy->address());
  const auto context = contextFor(dice.milliseconds(500, 5000));
  pb::WatchSceneRequest request;
  request.set_session(part_.session);
  mirror_.askIn(&request);
  const Moment asked = part_.moments->next();
  bool first = true;
  const auto stream = stubs.scene->WatchScene(context.get(), request);
  pb::WatchSceneResponse event;
  while (!stopping_ && stream->Read(&event)) {
    if (std::optional<Read> read = mirror_.take(event)) {
      read->reader = name_;
      if (first) read->asked = asked;
      first = false;
      record(std::move(*read), &scenePosition_);
    }
    if (!stays(dice)) break;
  }
  mirror_.breakOff();
  context->TryCancel();
  (void)stream->Finish();
  if (!stopping_) dice.pause(10, 80);
}

void Reader::watchVolumes(Dice& dice) {
  Stubs stubs(part_.proxy->address());
  const auto context = contextFor(dice.milliseconds(500, 5000));
  const auto stream = stubs.result->StreamVolume(context.get());
  pb::StreamVolumeRequest request;
  request.mutable_subscription()->set_session(part_.session);
  request.mutable_subscription()->set_format(pb::VOLUME_FORMAT_COMPACT);
  request.mutable_subscription()->set_max_rate(10.0);
  bool alive = stream->Write(request);
  pb::StreamVolumeResponse response;
  pb::VolumeHeader header;
  while (!stopping_ && alive && stream->Read(&response)) {
    if (!response.event().has_part()) continue;
    const pb::VolumePart& part = response.event().part();
    if (part.has_header()) header = part.header();
    if (part.index() + 1 != header.part_count()) continue;
    Read read;
    read.reader = name_ + "'s volumes";
    read.epoch = header.result().epoch();
    read.revision = header.result().revision();
    record(std::move(read), &volumePosition_);
    if (!stays(dice)) break;
    request.mutable_update()->mutable_acknowledge()->set_result_id(part.result_id());
    alive = stream->Write(request);
  }
  context->TryCancel();
  (void)stream->Finish();
  if (!stopping_) dice.pause(10, 80);
}

}  // namespace lpv::rpc::faults
