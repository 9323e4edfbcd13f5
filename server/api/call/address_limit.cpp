#include "api/call/address_limit.h"

#include <arpa/inet.h>

#include <charconv>
#include <cstring>
#include <optional>

namespace lpv::api {
namespace {

constexpr std::size_t kBytes = 16;
constexpr int kMappedBits = 96;         ///< ::ffff:0:0/96 holds IPv4
constexpr std::size_t kNetworkBytes = 8;
/// A caller who was silent for as long as its bucket takes to fill is as good as new.
constexpr std::chrono::seconds kSilence{2};
constexpr std::size_t kMostCallers = 100'000;
/// Who is refused so often within a window does not listen.
constexpr int kRefusalsOfFlood = 500;
constexpr std::chrono::seconds kWindow{1};
/// A ban is renewed for what was accepted while it began.
constexpr std::chrono::milliseconds kBanAgain{100};

/// "::ffff:" as bytes.
std::string mapped() {
  std::string out(kBytes, '\0');
  out[10] = out[11] = char(0xFF);
  return out;
}

/// 16 bytes; empty for what is no address.
std::string parsed(const std::string& text) {
  std::string out = mapped();
  if (inet_pton(AF_INET, text.c_str(), out.data() + kMappedBits / 8) == 1) return out;
  if (inet_pton(AF_INET6, text.c_str(), out.data()) == 1) return out;
  return {};
}

bool isMapped(const std::string& address) { return std::memcmp(address.data(), mapped().data(), kMappedBits / 8) == 0; }

std::optional<int> bitsOf(const std::string& text, int most) {
  int bits = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), bits);
  if (error != std::errc() || end != text.data() + text.size() || bits < 0 || bits > most) return std::nullopt;
  return bits;
}

std::string trimmed(const std::string& text) {
  const std::size_t first = text.find_first_not_of(' ');
  return first == std::string::npos ? std::string() : text.substr(first, text.find_last_not_of(' ') - first + 1);
}

bool sameBits(const std::string& a, const std::string& b, int bits) {
  const auto whole = std::size_t(bits / 8);
  if (std::memcmp(a.data(), b.data(), whole) != 0) return false;
  if (bits % 8 == 0) return true;
  const auto mask = std::uint8_t(0xFF << (8 - bits % 8));
  return ((std::uint8_t(a[whole]) ^ std::uint8_t(b[whole])) & mask) == 0;
}

Status refusal(const std::string& why) {
  constexpr const char* kField = "max_calls_per_second_per_address";
  return exhausted(Reason::kMaxCallsPerSecondPerAddress, kField, std::string(kField) + ": " + why)
      .retriedAfter(std::chrono::seconds(1));
}

Status tooMany(double perSecond) {
  return refusal("allowed are " + std::to_string(int(perSecond)) +
                 " from one address; slow down, or name the proxy that many clients come through in --trusted-proxy");
}

Status pilingUp() {
  return refusal("more than " + std::to_string(AddressLimit::kMostUnfinished) +
                 " calls of one connection were given up and have not ended yet; slow down");
}

}  // namespace

Expected<AddressList> AddressList::read(const std::string& flag, const std::string& text) {
  AddressList out;
  if (text == "none") return out;
  for (std::size_t at = 0; at <= text.size();) {
    const std::size_t comma = std::min(text.find(',', at), text.size());
    const std::string item = trimmed(text.substr(at, comma - at));
    at = comma + 1;
    const std::size_t slash = item.find('/');
    const std::string address = parsed(item.substr(0, slash));
    const int fixed = address.empty() || !isMapped(address) ? 0 : kMappedBits;
    const std::optional<int> bits =
        slash == std::string::npos ? std::optional(128 - fixed) : bitsOf(item.substr(slash + 1), 128 - fixed);
    if (address.empty() || !bits) {
      return invalid(flag, "--" + flag + ": \"" + item +
                               "\" is no address; give IPv4 or IPv6 addresses or networks, such as 10.1.2.3, "
                               "10.1.0.0/16 or fd00::/8, with commas between");
    }
    out.networks_.push_back({address, fixed + *bits});
  }
  return out;
}

bool AddressList::contains(const std::string& address) const {
  for (const Network& network : networks_) {
    if (sameBits(network.address, address, network.bits)) return true;
  }
  return false;
}

std::string addressOf(const std::string& peer) {
  const std::size_t colon = peer.rfind(':');
  if (peer.starts_with("ipv4:") && colon > 5) return parsed(peer.substr(5, colon - 5));
  constexpr std::string_view kOpen = "ipv6:%5B";
  const std::size_t close = peer.find("%5D", kOpen.size());
  if (!peer.starts_with(kOpen) || close == std::string::npos) return {};
  const std::string host = peer.substr(kOpen.size(), close - kOpen.size());
  return parsed(host.substr(0, host.find('%')));  // without the zone of a link-local address
}

std::string ipv4Address(const void* bytes) {
  std::string out = mapped();
  std::memcpy(out.data() + kMappedBits / 8, bytes, kBytes - kMappedBits / 8);
  return out;
}

std::string networkOf(std::string address) {
  if (!address.empty() && !isMapped(address)) address.resize(kNetworkBytes);
  return address;
}

/// Counts a refusal.
bool AddressLimit::floods(Caller& caller, Clock::time_point now) {
  if (now - caller.window > kWindow) {
    caller.window = now;
    caller.refusals = 0;
  }
  return ++caller.refusals >= kRefusalsOfFlood;
}

AddressLimit::Verdict AddressLimit::ban(Caller& caller, Status refusal, Clock::time_point now) {
  if (now < caller.bannedUntil - kBan + kBanAgain) return {std::move(refusal)};
  const bool news = now >= caller.bannedUntil;
  caller.bannedUntil = now + kBan;
  return {std::move(refusal), true, news};
}

AddressLimit::Verdict AddressLimit::begin(const std::string& peer, double perSecond, Clock::time_point now) {
  const std::string address = addressOf(peer);
  if (address.empty() || exempt_.contains(address)) return {};
  const MutexLock lock(mutex_);
  if (callers_.size() >= kMostCallers) forgetSilent(now);
  Caller& caller = callers_.try_emplace(networkOf(address), Caller{TokenBucket(perSecond, now), now}).first->second;
  caller.last = now;
  if (++unfinished_[peer] > kMostUnfinished) return ban(caller, pilingUp(), now);
  if (caller.bucket.take(perSecond, now)) return {};
  return floods(caller, now) ? ban(caller, tooMany(perSecond), now) : Verdict{tooMany(perSecond)};
}

void AddressLimit::ended(const std::string& peer) {
  const MutexLock lock(mutex_);
  const auto found = unfinished_.find(peer);
  if (found != unfinished_.end() && --found->second == 0) unfinished_.erase(found);
}

bool AddressLimit::banned(const std::string& address, Clock::time_point now) const {
  const MutexLock lock(mutex_);
  const auto found = callers_.find(networkOf(address));
  return found != callers_.end() && now < found->second.bannedUntil;
}

void AddressLimit::forgetSilent(Clock::time_point now) {
  std::erase_if(callers_, [now](const auto& entry) {
    return now - entry.second.last > kSilence && now >= entry.second.bannedUntil;
  });
  if (callers_.size() >= kMostCallers) callers_.clear();
}

}  // namespace lpv::api
