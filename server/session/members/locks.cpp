#include "session/members/locks.h"

#include <algorithm>
#include <type_traits>
#include <variant>

namespace lpv {
namespace {

/// The light or surface that an operation changes or deletes; empty for one that does neither.
std::string changedBy(const Operation& operation) {
  return std::visit(
      [](const auto& op) -> std::string {
        using Op = std::decay_t<decltype(op)>;
        if constexpr (std::is_same_v<Op, SetVertices>) {
          return op.object;
        } else if constexpr (std::is_same_v<Op, UpdateLight> || std::is_same_v<Op, DeleteLight> ||
                             std::is_same_v<Op, UpdateSurface> || std::is_same_v<Op, DeleteSurface>) {
          return op.name;
        } else {
          return {};
        }
      },
      operation);
}

}  // namespace

Status Locks::lock(const std::string& client, const std::vector<std::string>& names, Clock::duration time,
                   Clock::time_point now) {
  std::set<std::string> all(names.begin(), names.end());
  for (const std::string& name : all) {
    if (Status s = check(client, name, now); !s.ok()) return s;
  }
  for (const auto& [name, lock] : locks_) {
    if (lock.client == client && lock.until > now) all.insert(name);
  }
  if (all.size() > kMaxLocks) {
    return exhausted(Reason::kMaxLocks, "max_locks",
                     "max_locks: this client would have " + std::to_string(all.size()) +
                         " objects locked, allowed are " + std::to_string(kMaxLocks) + "; release some with ttl 0");
  }
  for (const std::string& name : names) locks_[name] = {client, now + time};
  return {};
}

void Locks::release(const std::string& client, const std::vector<std::string>& names) {
  std::erase_if(locks_, [&](const auto& entry) {
    const bool named = names.empty() || std::find(names.begin(), names.end(), entry.first) != names.end();
    return named && entry.second.client == client;
  });
}

Status Locks::check(const std::string& client, const std::string& name, Clock::time_point now) const {
  const auto found = locks_.find(name);
  if (found == locks_.end() || found->second.client == client || found->second.until <= now) return {};
  const auto left = std::chrono::ceil<std::chrono::seconds>(found->second.until - now);
  return {Code::kAborted, Reason::kLocked,
          "\"" + name + "\" is locked by client " + found->second.client + " for another " +
              std::to_string(left.count()) + " s; wait, or ask who it is (WatchScene tells)"};
}

Status Locks::check(const std::string& client, const Edit& edit, Clock::time_point now) const {
  if (locks_.empty()) return {};
  for (std::size_t i = 0; i < edit.operations.size(); ++i) {
    const Status status = check(client, changedBy(edit.operations[i]), now);
    if (!status.ok()) return status.within("operations[" + std::to_string(i) + "]");
  }
  return {};
}

std::set<std::string> Locks::expire(Clock::time_point now) {
  std::set<std::string> whose;
  std::erase_if(locks_, [&](const auto& entry) {
    const bool over = entry.second.until <= now;
    if (over) whose.insert(entry.second.client);
    return over;
  });
  return whose;
}

std::vector<std::string> Locks::heldBy(const std::string& client) const {
  std::vector<std::string> out;
  for (const auto& [name, lock] : locks_) {
    if (lock.client == client) out.push_back(name);
  }
  return out;
}

}  // namespace lpv
