#pragma once
// A snapshot and a step make the next snapshot. Pure.

#include <cstddef>
#include <map>
#include <string>

#include "base/status.h"
#include "lpv/store/v1/store.pb.h"

namespace lpv::store {

namespace pb = lpv::store::v1;

/// As many as sessions remember (session/document/document.h, session/members/members.h).
inline constexpr std::size_t kKeptTombstones = 10'000;
inline constexpr std::size_t kKeptOutcomes = 1024;
inline constexpr std::size_t kKeptNameBytes = std::size_t(4) << 20;
inline constexpr std::size_t kBytesPerName = 32;

/// DATA_LOSS where the record's revision is neither the snapshot's nor the next: a step is missing.
Status fold(const pb::Record& record, pb::Snapshot* snapshot);

/// Every blob that objects refer to or that was uploaded: hash to kind.
std::map<std::string, lpv::v1::BlobKind> contentsOf(const pb::Snapshot& snapshot);

}  // namespace lpv::store
