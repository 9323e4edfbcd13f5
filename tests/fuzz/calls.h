#pragma once
// Calls of inputs.proto against a World, as a door makes them, with what every answer has to keep to.

#include <map>
#include <memory>
#include <string>

#include "api/services.h"
#include "fuzz/inputs.pb.h"
#include "fuzz/world.h"

namespace lpv::fuzz {

/// A stream that is open, whatever it carries.
class OpenStream {
 public:
  virtual ~OpenStream() = default;
  /// Takes what the stream has to say; false once it has ended.
  virtual bool drain() = 0;
  /// The client sends no more.
  virtual void halfClose() = 0;
  virtual void cancel() = 0;
};

/// One client's calls, one after another.
class Caller {
 public:
  explicit Caller(bool tokens) : world_(tokens) {}
  ~Caller();

  void make(Call call);

  template <typename Request, typename Response>
  class Flow;

 private:
  void dispatch(const Call& call, const api::Context& context);
  template <typename Request, typename Response>
  void ask(Status (*function)(const api::Context&, const Request&, Response*), const Request& request,
           const api::Context& context);
  template <typename Request, typename Response>
  void askLater(void (*function)(const api::Context&, const Request&, Response*, api::Done), const Request& request,
                const api::Context& context);
  template <typename Request, typename Response>
  void say(Call::RequestCase kind, api::StreamPtr<Request, Response> (*open)(const api::Context&),
           const Request& request, const api::Context& context);
  void answered(const Status& status, google::protobuf::Message* response);
  void fillIn(google::protobuf::Message* call) const;
  void finishUploads(Call::RequestCase next);
  void forget(const OpenStream* gone);
  void drainAll();

  World world_;
  std::map<Call::RequestCase, std::unique_ptr<OpenStream>> streams_;
  OpenStream* last_ = nullptr;  ///< of the call that is made
  bool refused_ = false;        ///< the call that is made
  std::string subscriber_;
  std::string token_;
  std::string exported_;
};

}  // namespace lpv::fuzz
