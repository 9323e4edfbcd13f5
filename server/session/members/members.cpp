#include "session/members/members.h"

#include <algorithm>
#include <random>

#include "base/digest.h"
#include "base/text.h"

namespace lpv {

namespace {

std::size_t nameBytes(const EditOutcome& outcome) {
  std::size_t sum = 0;
  for (const auto* names : {&outcome.names, &outcome.skipped}) {
    for (const std::string& name : *names) sum += name.size() + kRememberedBytesPerName;
  }
  return sum;
}

}  // namespace

std::string randomHex(std::size_t bytes) {
  static constexpr char kDigits[] = "0123456789abcdef";
  std::random_device device;
  std::string out;
  while (out.size() < bytes * 2) {
    const unsigned value = device();
    for (int shift = 0; shift < 32 && out.size() < bytes * 2; shift += 4) out += kDigits[(value >> shift) & 0xFU];
  }
  return out;
}

Expected<ClientIdentity> Members::join() {
  if (full()) {
    return exhausted(Reason::kMaxClientsPerSession, "max_clients_per_session",
                     "max_clients_per_session: the session has " + std::to_string(members_.size()) +
                         " clients, allowed are " + std::to_string(limits_.maxClientsPerSession) +
                         "; one that neither has a stream nor says anything for " +
                         std::to_string(limits_.memberSilent.count()) + " s gives its place to the next");
  }
  const ClientIdentity identity{"c-" + randomHex(8), randomHex(16)};
  ClientState state;
  state.id = identity.id;
  state.secretHash = sha256(identity.secret);
  restore(state);
  return identity;
}

void Members::restore(const ClientState& state) {
  const Clock::time_point now = Clock::now();
  Client& client =
      members_.insert_or_assign(state.id, Client{state, {limits_.maxEditsPerSecond, now}, now}).first->second;
  for (const EditOutcome& outcome : client.outcomes) client.nameBytes += nameBytes(outcome);
  forgetOldest(client);
}

void Members::markActive(const std::string& id, Clock::time_point now) {
  const auto found = members_.find(id);
  if (found != members_.end()) found->second.heard = now;
}

std::string Members::silent(const std::set<std::string>& connected, Clock::time_point now) const {
  std::string longest;
  Clock::time_point since = now - limits_.memberSilent;
  for (const auto& [id, client] : members_) {
    if (client.heard > since || connected.contains(id)) continue;
    longest = id;
    since = client.heard;
  }
  return longest;
}

Status Members::verify(const ClientIdentity& identity) const {
  if (identity.id.empty()) return {};
  const auto found = members_.find(identity.id);
  if (found != members_.end() && found->second.secretHash == sha256(identity.secret)) return {};
  return Status(
      Code::kPermissionDenied, Reason::kUnknownClient,
      "client \"" + identity.id + "\" was not issued by this session, or its secret is another; call JoinSession",
      "client");
}

Expected<std::optional<EditOutcome>> Members::repeated(const std::string& id, std::uint64_t sequence) const {
  const auto found = members_.find(id);
  if (found == members_.end() || sequence == 0) return std::optional<EditOutcome>();
  const Client& client = found->second;
  const auto same = std::find_if(client.outcomes.begin(), client.outcomes.end(),
                                 [&](const EditOutcome& outcome) { return outcome.sequence == sequence; });
  if (same != client.outcomes.end()) return std::optional<EditOutcome>(*same);
  const std::uint64_t last = highest(client);
  if (sequence <= last) {
    return Status(Code::kFailedPrecondition, Reason::kSequenceOld,
                  "sequence " + std::to_string(sequence) + " is not above " + std::to_string(last) +
                      ", the highest answered, and has no outcome among the last " +
                      std::to_string(kRememberedOutcomes) + " edits of this client; send a higher one",
                  "sequence");
  }
  return std::optional<EditOutcome>();
}

std::uint64_t Members::highest(const ClientState& client) {
  std::uint64_t out = std::max(client.outcomeHorizon, client.acceptedSequence);
  for (const EditOutcome& outcome : client.outcomes) out = std::max(out, outcome.sequence);
  return out;
}

Status Members::admit(const std::string& id, Clock::time_point now) {
  const auto found = members_.find(id);
  TokenBucket& edits = found == members_.end() ? nobody_ : found->second.edits;
  if (edits.take(limits_.maxEditsPerSecond, now)) return {};
  return exhausted(Reason::kMaxEditsPerSecond, "max_edits_per_second",
                   "max_edits_per_second: allowed are " + std::to_string(limits_.maxEditsPerSecond) +
                       " edits a second per client; wait and repeat the same sequence");
}

namespace {

/// Bytes of a message that is kept: what a client wrote is repeated in it.
constexpr std::size_t kMostKeptText = 512;

std::string keptText(const std::string& text) {
  return text.size() <= kMostKeptText ? text : truncatedUtf8(text, kMostKeptText) + " ...";
}

}  // namespace

void Members::record(const std::string& id, const EditOutcome& outcome) {
  const auto found = members_.find(id);
  if (found == members_.end()) return;
  Client& client = found->second;
  if (outcome.status.ok()) {
    client.acceptedSequence = std::max(client.acceptedSequence, outcome.sequence);
    client.acceptedRevision = outcome.revision;
  }
  if (outcome.sequence == 0) return;
  client.outcomes.push_back(outcome);
  if (Status& s = client.outcomes.back().status; !s.ok()) s = {s.code(), keptText(s.message()), keptText(s.field())};
  client.nameBytes += nameBytes(outcome);
  forgetOldest(client);
}

void Members::forgetOldest(Client& client) {
  std::deque<EditOutcome>& outcomes = client.outcomes;
  while (outcomes.size() > kRememberedOutcomes || (outcomes.size() > 1 && client.nameBytes > kRememberedNameBytes)) {
    client.outcomeHorizon = std::max(client.outcomeHorizon, outcomes.front().sequence);
    client.nameBytes -= nameBytes(outcomes.front());
    outcomes.pop_front();
  }
}

std::uint64_t Members::acceptedSequence(const std::string& id) const {
  const auto found = members_.find(id);
  return found == members_.end() ? 0 : found->second.acceptedSequence;
}

std::map<std::string, std::uint64_t> Members::sequencesSince(std::uint64_t since) const {
  std::map<std::string, std::uint64_t> out;
  for (const auto& [id, client] : members_) {
    if (client.acceptedRevision > since) out[id] = client.acceptedSequence;
  }
  return out;
}

}  // namespace lpv
