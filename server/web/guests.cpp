#include "web/guests.h"

#include <algorithm>
#include <utility>

namespace lpv::web_door {

void Guests::add(const std::shared_ptr<Guest>& guest, bool visit) {
  const MutexLock lock(mutex_);
  guests_.push_back({guest.get(), guest, visit});
}

void Guests::remove(const Guest* guest) {
  const MutexLock lock(mutex_);
  guests_.remove_if([guest](const Entry& each) { return each.address == guest; });
  gone_.notifyAll();
}

std::shared_ptr<Guest> Guests::tooMany() {
  const MutexLock lock(mutex_);
  const auto isVisit = [](const Entry& each) { return each.visit; };
  if (std::size_t(std::count_if(guests_.begin(), guests_.end(), isVisit)) <= kMostVisits) return nullptr;
  const auto oldest = std::find_if(guests_.begin(), guests_.end(), isVisit);
  oldest->visit = false;
  return oldest->guest.lock();
}

std::vector<std::shared_ptr<Guest>> Guests::all() {
  const MutexLock lock(mutex_);
  std::vector<std::shared_ptr<Guest>> out;
  for (const Entry& each : guests_) {
    if (auto guest = each.guest.lock()) out.push_back(std::move(guest));
  }
  return out;
}

bool Guests::waitEmpty(Clock::time_point deadline) {
  MutexLock lock(mutex_);
  while (!guests_.empty()) {
    if (!gone_.waitUntil(lock, deadline)) return guests_.empty();
  }
  return true;
}

}  // namespace lpv::web_door
