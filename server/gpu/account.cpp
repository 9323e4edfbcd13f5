#include "gpu/account.h"

#include <utility>

namespace lpv::gpu {

namespace {

AccountPtr& charged() {
  thread_local AccountPtr account;
  return account;
}

}  // namespace

void chargeTo(AccountPtr account) { charged() = std::move(account); }

Charge::Charge(std::size_t bytes) : account_(charged()), bytes_(bytes) {
  if (account_ != nullptr) account_->bytes += std::int64_t(bytes_);
}

Charge::Charge(Charge&& other) noexcept : account_(std::move(other.account_)), bytes_(std::exchange(other.bytes_, 0)) {}

Charge& Charge::operator=(Charge&& other) noexcept {
  Charge taken(std::move(other));
  std::swap(account_, taken.account_);
  std::swap(bytes_, taken.bytes_);
  return *this;
}

Charge::~Charge() {
  if (account_ != nullptr) account_->bytes -= std::int64_t(bytes_);
}

}  // namespace lpv::gpu
