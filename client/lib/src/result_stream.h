#pragma once
// What volume and frame watchers share: credit, order, faults. `Kind` has what differs between the two.

#include <functional>
#include <memory>
#include <mutex>
#include <utility>

#include "assemble.h"
#include "connection.h"
#include "lpv/watch.h"
#include "reconnect_loop.h"

namespace lpv::client {

template <typename Kind>
class ResultStream {
 public:
  using Subscription = typename Kind::Subscription;
  using Result = typename Kind::Result;

  ResultStream(const Client& client, Subscription subscription, std::function<void(Result)> onResult, WatchHooks hooks)
      : connection_(client.connection()),
        subscription_(std::move(subscription)),
        onResult_(std::move(onResult)),
        hooks_(std::move(hooks)),
        loop_(connection_,
              {[this](grpc::ClientContext& context) { return attempt(context); }, hooks_.reopening, hooks_.ended}) {
    subscription_.set_session(sessionName(subscription_.session()));
    loop_.start();
  }

  void stop() { loop_.stop(); }

  WatchStats stats() const {
    const std::lock_guard lock(mutex_);
    WatchStats out = stats_;
    out.reopened = loop_.reopened();
    return out;
  }

  /// Changes the subscription that a reconnect starts with, and updates the open stream.
  template <typename Change>
  void update(const Change& change) {
    const std::lock_guard lock(mutex_);
    v1::SubscriberUpdate message;
    change(subscription_, message);
    write(message);
  }

 private:
  using Request = typename Kind::Request;
  using Response = typename Kind::Response;
  using Stream = grpc::ClientReaderWriter<Request, Response>;

  /// The caller holds mutex_.
  void write(const v1::SubscriberUpdate& update) {
    if (stream_ == nullptr) return;
    Request request;
    *request.mutable_update() = update;
    stream_->Write(request);  // a failure shows in the next Read
  }

  grpc::Status attempt(grpc::ClientContext& context) {
    const std::unique_ptr<Stream> stream = Kind::open(*connection_, context);
    {
      const std::lock_guard lock(mutex_);
      stream_ = stream.get();
      Request request;
      *request.mutable_subscription() = subscription_;
      stream->Write(request);
    }
    typename Kind::Assembler assembler;
    Response response;
    while (loop_.read(*stream, response)) handle(response, assembler);
    {
      const std::lock_guard lock(mutex_);
      stream_ = nullptr;
    }
    return stream->Finish();
  }

  void handle(const Response& response, typename Kind::Assembler& assembler) {
    const auto& event = response.event();
    if (event.has_part()) handlePart(event.part(), assembler);
    if (event.has_subscribed() && hooks_.subscribed) hooks_.subscribed(event.subscribed());
    if (event.has_heartbeat() && hooks_.heartbeat) hooks_.heartbeat(event.heartbeat());
    if (event.has_notice() && hooks_.notice) hooks_.notice(event.notice());
  }

  template <typename Part>
  void handlePart(const Part& part, typename Kind::Assembler& assembler) {
    auto added = assembler.add(part);
    v1::SubscriberUpdate update;
    update.mutable_acknowledge()->set_result_id(part.result_id());
    if (!added) {
      update.set_request_key_frame(Kind::kHasBases);
      count(&WatchStats::faults, 1);
    } else if (*added) {
      deliver(std::move(**added));
    } else {
      return;  // more parts to come
    }
    const std::lock_guard lock(mutex_);
    write(update);
  }

  void deliver(Result result) {
    const v1::ResultInfo& info = result.header.result();
    const std::pair<std::uint64_t, std::uint64_t> order(info.epoch(), info.revision());
    if (order < newest_) return count(&WatchStats::discarded, 1);
    newest_ = order;
    if (hooks_.latency) hooks_.latency->seen(info.client_sequence());
    count(&WatchStats::results, 1);
    count(&WatchStats::bytes, Kind::bytes(result));
    if (onResult_) onResult_(std::move(result));
  }

  void count(std::uint64_t WatchStats::*number, std::uint64_t by) {
    const std::lock_guard lock(mutex_);
    stats_.*number += by;
  }

  std::shared_ptr<Connection> connection_;
  mutable std::mutex mutex_;  ///< guards subscription_, stream_ and writing to it, stats_
  Subscription subscription_;
  Stream* stream_ = nullptr;
  WatchStats stats_;
  std::function<void(Result)> onResult_;
  WatchHooks hooks_;
  std::pair<std::uint64_t, std::uint64_t> newest_;  ///< newest (epoch, revision) delivered; reading thread only
  ReconnectLoop loop_;                                  ///< last member: its thread uses all others
};

}  // namespace lpv::client
