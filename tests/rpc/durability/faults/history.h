#pragma once
// What happened in a run with faults, as those saw it who took part. The checker (checker.h) is told nothing else.

#include <compare>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace lpv::rpc::faults {

/// A place in the order of a run's events: what has a smaller one was over before.
using Moment = std::uint64_t;

/// An edit: the writer and its sequence. It creates a surface with its name, which nobody deletes, gives the lamp a
/// colour that says which edit it was, creates a scratch light, and may delete the scratch light of an earlier edit of
/// the same writer. So the scene says which edits were done, in which order, and whether in whole.
struct EditId {
  int writer = 0;
  std::uint64_t sequence = 0;
  auto operator<=>(const EditId&) const = default;
};
inline std::string nameOf(const EditId& id) {
  return "w" + std::to_string(id.writer) + "-" + std::to_string(id.sequence);
}
inline std::string scratchOf(const EditId& id) { return nameOf(id) + "-scratch"; }

/// What a writer was told.
enum class Outcome {
  kUnknown,   ///< nothing, or that the outcome is not known
  kAccepted,
  kRefused,
};

/// An edit that was sent once.
struct Attempt {
  EditId id;
  std::uint64_t removes = 0;  ///< sequence of the edit whose scratch light it deletes; 0: none
  Moment began = 0;
  Moment ended = 0;
  Outcome outcome = Outcome::kUnknown;
  std::uint64_t revision = 0;  ///< where accepted
  std::string name;            ///< likewise: what the surface is called
  std::string why;             ///< where not
};

struct Object {
  std::uint64_t revision = 0;  ///< that last changed it
  std::uint64_t hash = 0;      ///< of all of it
  bool operator==(const Object&) const = default;
};

/// The scene at a revision.
struct SceneState {
  std::uint64_t epoch = 0;
  std::uint64_t revision = 0;
  std::map<std::string, Object> objects;
  std::string last;  ///< the edit that the lamp's colour says; empty before the first
  bool operator==(const SceneState&) const = default;
};

/// What a reader held after a message, or after the last of its parts.
struct Read {
  std::string reader;
  std::uint64_t epoch = 0;
  std::uint64_t revision = 0;
  /// Of the first message of a stream: when the stream was asked for.
  std::optional<Moment> asked;
  /// Of a change: the revision that it says it follows.
  std::optional<std::uint64_t> follows;
  /// Of the whole scene then; unset where this is no reader of scenes.
  std::optional<std::uint64_t> digest;
  /// The edit that the lamp's colour says is there with its surface.
  bool whole = true;
};

/// A reader's copy of the scene at the end.
struct Mirror {
  std::string reader;
  SceneState scene;
};

struct History {
  std::uint64_t firstRevision = 0;         ///< before the first edit
  std::vector<std::string> firstObjects;   ///< likewise
  std::vector<Attempt> attempts;
  std::vector<Read> reads;                 ///< those of one reader in order
  std::vector<Mirror> mirrors;
  SceneState truth;                        ///< the server's, after its last start
};

}  // namespace lpv::rpc::faults
