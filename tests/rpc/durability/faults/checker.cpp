#include "rpc/durability/faults/checker.h"

#include <algorithm>
#include <set>
#include <utility>

namespace lpv::rpc::faults {
namespace {

const char* labelOf(Fault fault) {
  switch (fault) {
    case Fault::kLost:
      return "lost";
    case Fault::kTwice:
      return "twice";
    case Fault::kOutcomeChanged:
      return "outcome changed";
    case Fault::kRefusedButDone:
      return "refused but done";
    case Fault::kInPart:
      return "in part";
    case Fault::kOutOfOrder:
      return "out of order";
    case Fault::kBackwards:
      return "backwards";
    case Fault::kGap:
      return "gap";
    case Fault::kStale:
      return "stale";
    case Fault::kMirrorsDiffer:
      return "mirrors differ";
  }
  return "?";
}

std::string at(std::uint64_t epoch, std::uint64_t revision) {
  return "(" + std::to_string(epoch) + ", " + std::to_string(revision) + ")";
}

class Checker {
 public:
  explicit Checker(const History& history) : history_(history) {}

  std::vector<Violation> run() {
    readAttempts();
    checkPresence();
    checkNames();
    checkParts();
    checkRevisions();
    checkOrder();
    checkReads();
    checkDigests();
    checkMirrors();
    return std::move(found_);
  }

 private:
  /// All that is known of an edit from its attempts.
  struct Edit {
    Moment began = ~Moment(0);  ///< of its first attempt
    std::uint64_t removes = 0;
    const Attempt* accepted = nullptr;  ///< the first that was
    const Attempt* refused = nullptr;
  };

  void report(Fault fault, std::string what) { found_.push_back({fault, std::move(what)}); }

  /// Collects edits and acknowledgements; answers to one sequence have to agree.
  void readAttempts() {
    for (const Attempt& attempt : history_.attempts) {
      Edit& edit = edits_[attempt.id];
      edit.began = std::min(edit.began, attempt.began);
      edit.removes = attempt.removes;
      if (attempt.outcome == Outcome::kRefused && !edit.refused) edit.refused = &attempt;
      if (attempt.outcome != Outcome::kAccepted) continue;
      acknowledged_.emplace_back(attempt.ended, attempt.revision);
      if (attempt.name != nameOf(attempt.id)) {
        report(Fault::kTwice, nameOf(attempt.id) + " was acknowledged as " + attempt.name);
      }
      if (!edit.accepted) edit.accepted = &attempt;
      if (attempt.revision != edit.accepted->revision) {
        report(Fault::kOutcomeChanged, nameOf(attempt.id) + " was acknowledged as revision " +
                                           std::to_string(edit.accepted->revision) + " and as " +
                                           std::to_string(attempt.revision));
      }
    }
    for (const auto& [id, edit] : edits_) {
      if (edit.accepted && edit.refused) {
        report(Fault::kOutcomeChanged, nameOf(id) + " was acknowledged and refused: " + edit.refused->why);
      }
    }
    std::sort(acknowledged_.begin(), acknowledged_.end());
    std::uint64_t highest = 0;
    for (auto& [moment, revision] : acknowledged_) revision = highest = std::max(highest, revision);
  }

  /// Acknowledged edits are there as they were acknowledged, refused ones are not, others may be.
  void checkPresence() {
    for (const auto& [id, edit] : edits_) {
      const auto there = history_.truth.objects.find(nameOf(id));
      if (there == history_.truth.objects.end()) {
        if (!edit.accepted) continue;
        report(Fault::kLost, nameOf(id) + ", acknowledged as revision " + std::to_string(edit.accepted->revision) +
                                 ", is not in the final state");
        continue;
      }
      done_[id] = there->second.revision;
      if (edit.refused) report(Fault::kRefusedButDone, nameOf(id) + ": " + edit.refused->why);
      if (edit.accepted && edit.accepted->revision != there->second.revision) {
        report(Fault::kOutcomeChanged, nameOf(id) + ", acknowledged as revision " +
                                           std::to_string(edit.accepted->revision) + ", is there as revision " +
                                           std::to_string(there->second.revision));
      }
    }
  }

  /// A name that is taken gets a number: what nobody asked for was made by an edit that was done again.
  void checkNames() {
    std::set<std::string> asked(history_.firstObjects.begin(), history_.firstObjects.end());
    for (const auto& [id, edit] : edits_) {
      asked.insert(nameOf(id));
      asked.insert(scratchOf(id));
    }
    for (const auto& [name, object] : history_.truth.objects) {
      if (!asked.contains(name)) report(Fault::kTwice, name + " is there, which no edit asked for");
    }
  }

  /// The scratch light of an edit is there exactly where the edit was done and none that deletes it was.
  void checkParts() {
    std::set<EditId> removed;
    for (const auto& [id, revision] : done_) {
      if (const std::uint64_t sequence = edits_[id].removes) removed.insert({id.writer, sequence});
    }
    for (const auto& [id, edit] : edits_) {
      const bool there = history_.truth.objects.contains(scratchOf(id));
      const bool expected = done_.contains(id) && !removed.contains(id);
      if (there != expected) report(Fault::kInPart, scratchOf(id) + (there ? " is" : " is not") + " there");
    }
  }

  /// One edit, one revision; the lamp has its colour from the last.
  void checkRevisions() {
    std::map<std::uint64_t, EditId> byRevision;
    for (const auto& [id, revision] : done_) {
      const auto [other, isNew] = byRevision.try_emplace(revision, id);
      if (!isNew) {
        report(Fault::kOutOfOrder,
               nameOf(id) + " and " + nameOf(other->second) + " both are revision " + std::to_string(revision));
      }
    }
    const std::uint64_t made = history_.truth.revision - history_.firstRevision;
    if (made != done_.size()) {
      report(Fault::kTwice,
             std::to_string(made) + " revisions were made by " + std::to_string(done_.size()) + " edits");
    }
    const std::string last = byRevision.empty() ? std::string() : nameOf(byRevision.rbegin()->second);
    if (history_.truth.last != last) {
      report(Fault::kInPart, "the lamp says \"" + history_.truth.last + "\", the last edit was \"" + last + "\"");
    }
  }

  /// The highest revision acknowledged before a moment; 0 for none.
  std::uint64_t acknowledgedBefore(Moment moment) const {
    const auto after =
        std::lower_bound(acknowledged_.begin(), acknowledged_.end(), std::pair(moment, std::uint64_t(0)));
    return after == acknowledged_.begin() ? 0 : std::prev(after)->second;
  }

  void checkOrder() {
    for (const auto& [id, revision] : done_) {
      const std::uint64_t before = acknowledgedBefore(edits_[id].began);
      if (revision <= before) {
        report(Fault::kOutOfOrder, nameOf(id) + " is revision " + std::to_string(revision) + ", revision " +
                                       std::to_string(before) + " was acknowledged before it was sent");
      }
    }
  }

  void checkReads() {
    std::map<std::string, const Read*> before;
    for (const Read& read : history_.reads) {
      const std::string here = read.reader + " at " + at(read.epoch, read.revision);
      if (!read.whole) report(Fault::kInPart, here + ": the lamp has the colour of an edit whose surface is missing");
      if (read.asked && read.revision < acknowledgedBefore(*read.asked)) {
        report(Fault::kStale, here + ": revision " + std::to_string(acknowledgedBefore(*read.asked)) +
                                  " was acknowledged before it asked");
      }
      const Read*& last = before[read.reader];
      if (last && std::pair(read.epoch, read.revision) < std::pair(last->epoch, last->revision)) {
        report(Fault::kBackwards, here + " had seen " + at(last->epoch, last->revision));
      }
      const bool follows = last && last->epoch == read.epoch && last->revision == read.follows;
      if (read.follows && !follows) {
        report(Fault::kGap, here + " was told a change that follows " + std::to_string(*read.follows));
      }
      last = &read;
    }
  }

  void checkDigests() {
    std::map<std::pair<std::uint64_t, std::uint64_t>, const Read*> first;
    for (const Read& read : history_.reads) {
      if (!read.digest) continue;
      const auto [other, isNew] = first.try_emplace({read.epoch, read.revision}, &read);
      if (!isNew && other->second->digest != read.digest) {
        report(Fault::kMirrorsDiffer,
               read.reader + " and " + other->second->reader + " differ at " + at(read.epoch, read.revision));
      }
    }
  }

  void checkMirrors() {
    const SceneState& truth = history_.truth;
    for (const Mirror& mirror : history_.mirrors) {
      if (mirror.scene == truth) continue;
      std::string what = mirror.reader + " ended at " + at(mirror.scene.epoch, mirror.scene.revision) + " with " +
                         std::to_string(mirror.scene.objects.size()) + " objects, the server at " +
                         at(truth.epoch, truth.revision) + " with " + std::to_string(truth.objects.size());
      for (const auto& [name, object] : truth.objects) {
        const auto held = mirror.scene.objects.find(name);
        if (held != mirror.scene.objects.end() && held->second == object) continue;
        what += "; first difference: " + name;
        break;
      }
      report(Fault::kMirrorsDiffer, std::move(what));
    }
  }

  const History& history_;
  std::map<EditId, Edit> edits_;
  std::map<EditId, std::uint64_t> done_;                         ///< what the final state has, with its revision
  std::vector<std::pair<Moment, std::uint64_t>> acknowledged_;  ///< in order; the highest revision up to then
  std::vector<Violation> found_;
};

}  // namespace

std::vector<Violation> check(const History& history) { return Checker(history).run(); }

std::string describe(const std::vector<Violation>& violations, std::size_t most) {
  std::string out;
  for (std::size_t i = 0; i < std::min(most, violations.size()); ++i) {
    out += std::string(labelOf(violations[i].fault)) + ": " + violations[i].what + "\n";
  }
  if (violations.size() > most) out += "and " + std::to_string(violations.size() - most) + " more\n";
  return out;
}

}  // namespace lpv::rpc::faults
