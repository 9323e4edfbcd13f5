#include "rpc/durability/faults/run.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "rpc/durability/faults/reader.h"
#include "rpc/durability/faults/writer.h"

namespace lpv::rpc::faults {
namespace {

constexpr int kWriters = 4;
constexpr int kReaders = 4;

/// A page of a list after the other; false where the scene changed meanwhile.
template <typename Request, typename Response, typename List>
bool readAll(const std::string& session, std::uint64_t revision, List list) {
  Request request;
  request.set_session(session);
  request.set_page_size(1000);
  do {
    Response response;
    if (!list(request, &response) || response.revision() != revision) return false;
    request.set_page_token(response.next_page_token());
  } while (!request.page_token().empty());
  return true;
}

/// The scene as unary calls tell it.
SceneBuilder sceneOf(Stubs& stubs, const std::string& session) {
  SceneBuilder out;
  const bool read = eventually([&] {
    out.clear();
    const pb::Session now = getSession(stubs, session);
    out.stand(now.epoch(), now.revision());
    const auto lights = [&](const pb::ListLightsRequest& request, pb::ListLightsResponse* response) {
      const bool ok = stubs.scene->ListLights(Call(), request, response).ok();
      for (pb::Light& light : *response->mutable_lights()) {
        light.mutable_status()->clear_area();  // a list says it, the stream of changes does not
        out.put(light);
      }
      return ok;
    };
    const auto surfaces = [&](const pb::ListSurfacesRequest& request, pb::ListSurfacesResponse* response) {
      const bool ok = stubs.scene->ListSurfaces(Call(), request, response).ok();
      for (const pb::Surface& surface : response->surfaces()) out.put(surface);
      return ok;
    };
    return readAll<pb::ListLightsRequest, pb::ListLightsResponse>(session, now.revision(), lights) &&
           readAll<pb::ListSurfacesRequest, pb::ListSurfacesResponse>(session, now.revision(), surfaces);
  });
  EXPECT_TRUE(read) << "the scene does not come to rest";
  return out;
}

class Run {
 public:
  Run(Service& service, const RunOptions& options) : service_(service), options_(options), dice_(options.seed) {}

  History go() {
    open();
    faults();
    heal();
    finishWriting();
    compareWhileItLives();
    if (options_.kills) restart(&Service::kill);
    end();
    return std::move(history_);
  }
  const Tally& tally() const { return tally_; }

 private:
  void open() {
    session_ = makeLitSession(service_.stubs());
    const SceneState before = sceneOf(service_.stubs(), session_).state();
    history_.firstRevision = before.revision;
    for (const auto& [name, object] : before.objects) history_.firstObjects.push_back(name);
    for (int i = 0; i < kWriters + kReaders; ++i) proxies_.push_back(std::make_unique<TcpProxy>(service_.port()));
    for (int i = 0; i < kReaders; ++i) {
      readers_.push_back(std::make_unique<Reader>("reader " + std::to_string(i), i % 2 == 0, part(kWriters + i)));
    }
    for (int i = 0; i < kWriters; ++i) {
      const pb::ClientIdentity identity = join(service_.stubs(), session_);
      writers_.push_back(std::make_unique<Writer>(i + 1, i % 2 == 0 ? Way::kCalls : Way::kStream, part(i), identity));
    }
  }

  Part part(int i) {
    return {session_, options_.seed * 1000 + std::uint64_t(i) * 10, options_.mostEdits, &moments_,
            proxies_[std::size_t(i)].get()};
  }
  TcpProxy& anyProxy() { return *proxies_[std::size_t(dice_.between(0, kWriters + kReaders - 1))]; }

  void restart(void (Service::*stop)()) {
    for (const auto& proxy : proxies_) proxy->setTarget(0);
    (service_.*stop)();
    if (dice_.once(2)) dice_.pause(0, 300);
    service_.start();
    for (const auto& proxy : proxies_) proxy->setTarget(service_.port());
    ++tally_.kills;
  }
  void pauseFor(std::chrono::milliseconds length) {
    service_.pause();
    std::this_thread::sleep_for(length);
    service_.resume();
  }
  /// Answers are lost with the connection: the client does not know what it did.
  void loseAnswers() {
    TcpProxy& proxy = anyProxy();
    proxy.holdAnswers(true);
    dice_.pause(50, 600);
    proxy.cut();
    proxy.holdAnswers(false);
  }
  /// Requests arrive late: after the client has given up, or has repeated them elsewhere.
  void delayRequests() {
    TcpProxy& proxy = anyProxy();
    proxy.holdRequests(true);
    dice_.pause(100, 1500);
    proxy.holdRequests(false);
  }

  /// All kinds of faults in a new order, again and again.
  void faults() {
    const auto until = std::chrono::steady_clock::now() + options_.length;
    std::vector<std::function<void()>> deck = {
        [this] { anyProxy().cut(); },
        [this] { anyProxy().cut(); },
        [this] { loseAnswers(); },
        [this] { loseAnswers(); },
        [this] { delayRequests(); },
        [this] { delayRequests(); },
        [this] { anyProxy().setDelay(dice_.milliseconds(0, 60)); },
    };
    if (options_.kills) {
      deck.insert(deck.end(), {[this] { restart(&Service::kill); }, [this] { restart(&Service::kill); },
                               [this] { restart(&Service::drain); }, [this] { pauseFor(dice_.milliseconds(50, 1500)); },
                               [this] {
                                 service_.pause();
                                 dice_.pause(0, 500);
                                 restart(&Service::kill);
                               }});
    }
    while (std::chrono::steady_clock::now() < until) {
      std::shuffle(deck.begin(), deck.end(), dice_.engine());
      for (const auto& fault : deck) {
        dice_.pause(30, 300);
        fault();
        ++tally_.otherFaults;
        if (std::chrono::steady_clock::now() >= until) break;
      }
    }
    tally_.otherFaults -= tally_.kills;
  }

  void heal() {
    for (const auto& proxy : proxies_) {
      proxy->setDelay(std::chrono::milliseconds(0));
      proxy->cut();
    }
    for (const auto& reader : readers_) reader->calm();
  }

  void finishWriting() {
    for (const auto& writer : writers_) writer->finish();
    for (const auto& writer : writers_) {
      writer->join();
      EXPECT_TRUE(writer->finished()) << "a server that is well did not answer";
      const std::vector<Attempt>& attempts = writer->attempts();
      history_.attempts.insert(history_.attempts.end(), attempts.begin(), attempts.end());
    }
  }

  /// The server's scene once every reader has got as far.
  SceneBuilder settled() {
    SceneBuilder out;
    const bool arrived = eventually([&] {
      out = sceneOf(service_.stubs(), session_);
      const Position here{out.state().epoch, out.state().revision};
      return std::all_of(readers_.begin(), readers_.end(),
                         [&](const auto& reader) { return reader->position() == here; });
    });
    EXPECT_TRUE(arrived) << "a reader does not arrive at (" << out.state().epoch << ", " << out.state().revision << ")";
    return out;
  }

  /// Mirrors that were made by resuming, before a restart gives everybody a snapshot.
  void compareWhileItLives() {
    const SceneBuilder scene = settled();
    Read read;
    read.reader = "the lists";
    read.epoch = scene.state().epoch;
    read.revision = scene.state().revision;
    read.digest = scene.digest();
    read.whole = scene.whole();
    history_.reads.push_back(read);
  }

  void end() {
    history_.truth = settled().state();
    for (const auto& reader : readers_) reader->stop();
    for (const auto& reader : readers_) {
      history_.reads.insert(history_.reads.end(), reader->reads().begin(), reader->reads().end());
      history_.mirrors.push_back(reader->mirror());
    }
    pb::DeleteSessionRequest request;
    request.set_name(session_);
    pb::DeleteSessionResponse response;
    EXPECT_THAT(service_.stubs().session->DeleteSession(Call(), request, &response), IsOk());
    count();
  }

  void count() {
    std::set<EditId> known;
    for (const Attempt& attempt : history_.attempts) {
      if (attempt.outcome == Outcome::kUnknown) ++tally_.unknown;
      if (attempt.outcome != Outcome::kAccepted) continue;
      ++(known.insert(attempt.id).second ? tally_.accepted : tally_.repeated);
    }
    tally_.reads = history_.reads.size();
  }

  Service& service_;
  const RunOptions options_;
  Dice dice_;
  Moments moments_;
  std::string session_;
  std::vector<std::unique_ptr<TcpProxy>> proxies_;
  std::vector<std::unique_ptr<Reader>> readers_;
  std::vector<std::unique_ptr<Writer>> writers_;
  History history_;
  Tally tally_;
};

}  // namespace

void Tally::add(const Tally& other) {
  kills += other.kills;
  otherFaults += other.otherFaults;
  accepted += other.accepted;
  unknown += other.unknown;
  repeated += other.repeated;
  reads += other.reads;
}

History run(Service& service, const RunOptions& options, Tally* tally) {
  Run one(service, options);
  History out = one.go();
  tally->add(one.tally());
  return out;
}

}  // namespace lpv::rpc::faults
