#pragma once
// A reader of results that knows what a stream owes it.

#include <gtest/gtest.h>

#include <string>
#include <type_traits>
#include <utility>

#include "rpc/support/rpc.h"

namespace lpv::rpc {

/// What a reader has seen of a stream, checked for its order.
template <typename Response>
struct Seen {
  using Header = std::remove_cvref_t<decltype(std::declval<Response>().event().part().header())>;
  pb::ResultInfo result;  ///< of the last result
  Header header;          ///< likewise
  std::string subscriber;
  int heartbeats = 0;
  int results = 0;
  pb::Notice notice;

  /// Takes an event; true when it completes a result.
  bool take(const Response& response) {
    const auto& event = response.event();
    if (event.has_subscribed()) subscriber = event.subscribed().subscriber();
    if (event.has_heartbeat()) ++heartbeats;
    if (event.has_notice()) notice = event.notice();
    if (!event.has_part()) return false;
    if (event.part().has_header()) {
      const pb::ResultInfo& next = event.part().header().result();
      if (results > 0) {
        EXPECT_GE(std::pair(next.epoch(), next.revision()), std::pair(result.epoch(), result.revision()));
        EXPECT_GT(next.result_id(), result.result_id());
      }
      result = next;
      header = event.part().header();
    }
    if (event.part().index() + 1 != header.part_count()) return false;
    ++results;
    return true;
  }
  /// Reads up to the next whole result; false where the stream ended.
  template <typename Stream>
  bool next(Stream& stream) {
    Response response;
    while (stream.Read(&response)) {
      if (take(response)) return true;
    }
    return false;
  }
  /// Reads until `more` further heartbeats have come; results that come in between are counted.
  template <typename Stream>
  void waitHeartbeats(Stream& stream, int more) {
    Response response;
    const int until = heartbeats + more;
    while (heartbeats < until && stream.Read(&response)) take(response);
    EXPECT_EQ(heartbeats, until);
  }
};

}  // namespace lpv::rpc
