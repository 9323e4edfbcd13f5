#pragma once
// How many calls one address may begin in a second: a flood of calls from one machine costs its own calls, not those of
// others. Addresses behind which are many clients, as a proxy's, are exempt; such limits are the proxy's then.

#include <chrono>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "base/mutex.h"
#include "base/status.h"
#include "base/timers.h"
#include "base/token_bucket.h"

namespace lpv::api {

/// Addresses or networks: "127.0.0.0/8, ::1, 10.1.2.3".
class AddressList {
 public:
  /// INVALID_ARGUMENT at `flag` for what is no list of IPv4 or IPv6 addresses, each with or without /BITS.
  /// "none" is an empty list.
  static Expected<AddressList> read(const std::string& flag, const std::string& text);
  /// `address`: 16 bytes, IPv4 as ::ffff:a.b.c.d.
  bool contains(const std::string& address) const;

 private:
  struct Network {
    std::string address;
    int bits = 128;
  };
  std::vector<Network> networks_;
};

/// The address in gRPC's text of a peer ("ipv4:10.1.2.3:50000", "ipv6:%5B::1%5D:50000"), as 16 bytes; empty for other
/// peers, such as Unix sockets.
std::string addressOf(const std::string& peer);

/// The same of four bytes in network order.
std::string ipv4Address(const void* bytes);
/// What counts as one caller: an IPv4 address, or a network of 64 bits of IPv6, which is what one customer has at
/// least.
std::string networkOf(std::string address);

/// Thread-safe.
class AddressLimit {
 public:
  explicit AddressLimit(AddressList exempt) : exempt_(std::move(exempt)) {}

  struct Verdict {
    Status status;
    bool flood = false;  ///< the connections of the address that are open now are to be shut down
    bool news = false;  ///< because a ban has begun
  };
  /// RESOURCE_EXHAUSTED, max_calls_per_second_per_address, where the peer has begun too many. Who goes on all the same
  /// floods, and is banned for kBan.
  /// So does a connection whose calls pile up unfinished: it gives them up faster than they can end, however slow that
  /// is. Each call that began, refused or not, ends by ended().
  Verdict begin(const std::string& peer, double perSecond, Clock::time_point now);
  void ended(const std::string& peer);
  /// Many clients may be behind the address (of addressOf()): limits by address are those of a proxy.
  bool exempts(const std::string& address) const { return exempt_.contains(address); }
  /// No connections are taken from the address (of addressOf()) now.
  bool banned(const std::string& address, Clock::time_point now) const;

  static constexpr std::chrono::seconds kBan{10};
  /// Five times as many as a connection may have open. Calls that were given up leave the connection room for others
  /// before they have ended here.
  static constexpr int kMostUnfinished = 500;

 private:
  struct Caller {
    TokenBucket bucket;
    Clock::time_point last;
    Clock::time_point window{};  ///< a second in which refusals are counted begins here
    int refusals = 0;
    Clock::time_point bannedUntil{};
  };
  static bool floods(Caller& caller, Clock::time_point now);
  static Verdict ban(Caller& caller, Status refusal, Clock::time_point now);
  void forgetSilent(Clock::time_point now) LPV_REQUIRES(mutex_);

  const AddressList exempt_;
  mutable Mutex mutex_;
  std::map<std::string, Caller> callers_ LPV_GUARDED_BY(mutex_);  ///< by networkOf()
  std::map<std::string, int> unfinished_ LPV_GUARDED_BY(mutex_);  ///< calls, by peer
};

}  // namespace lpv::api
