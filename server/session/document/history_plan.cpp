// Steps taken back and made again.

#include <algorithm>
#include <iterator>

#include "session/document/history.h"

namespace lpv {
namespace {

Status nothingTo(UndoDirection direction, int kept) {
  const std::string what =
      direction == UndoDirection::kUndo
          ? "there is nothing to undo: this client has no steps left; the last " + std::to_string(kept) + " are kept"
          : "there is nothing to redo: this client has undone nothing since its last edit; steps "
            "are kept";
  return {Code::kFailedPrecondition, Reason::kNothingToUndo,
          what + " in memory, since the server has started or brought the session back", "client"};
}

template <typename Change>
auto& sideFrom(Change& change, UndoDirection direction) {
  return direction == UndoDirection::kUndo ? change.after : change.before;
}

template <typename Change>
auto& sideTo(Change& change, UndoDirection direction) {
  return direction == UndoDirection::kUndo ? change.before : change.after;
}

}  // namespace

Expected<History::Plan> History::plan(const std::string& client, UndoDirection direction,
                                      const Document& document) const {
  const auto member = members_.find(client);
  if (member == members_.end()) return nothingTo(direction, limits_.maxUndoSteps);
  const std::deque<Step>& steps = direction == UndoDirection::kUndo ? member->second.undo : member->second.redo;
  if (steps.empty()) return nothingTo(direction, limits_.maxUndoSteps);
  const Step& step = steps.back();
  Plan out;
  out.applied.number = step.number;
  // No group: an edit made after an undo begins a step of its own, whatever group it names.
  for (const auto& [key, change] : step.wholes) planWhole(key, change, direction, document, out);
  for (const auto& [place, change] : step.fields) {
    planField(place.first, place.second, change, direction, document, out);
  }
  planGrid(step, direction, document, out);
  for (const auto& [key, state] : out.states) out.objects.emplace_back(key, state);
  std::sort(out.skipped.begin(), out.skipped.end());
  out.skipped.erase(std::unique(out.skipped.begin(), out.skipped.end()), out.skipped.end());
  return out;
}

void History::planWhole(const ObjectKey& key, const WholeChange& change, UndoDirection direction,
                        const Document& document, Plan& plan) const {
  const WholeSide& from = sideFrom(change, direction);
  const NameBinding* now = find(key);
  if (!now || !(*now == from.standing)) {
    plan.skipped.push_back(key.name);
    return;
  }
  const ObjectState object = document.object(key);
  bool changed = false;
  for (std::size_t field = 0; now->life && field < fieldCount(object); ++field) {
    if (now->life->writes[field] == from.writes[field]) continue;
    changed = true;
    plan.skipped.push_back(fieldName(key, object, field));
  }
  if (changed) return;
  WholeChange applied = change;
  sideFrom(applied, direction).object = object;
  plan.states[key] = sideTo(applied, direction).object;
  plan.applied.wholes[key] = std::move(applied);
}

void History::planField(const IncarnationPtr& life, std::size_t field, const FieldChange& change,
                        UndoDirection direction, const Document& document, Plan& plan) const {
  const FieldSide& from = sideFrom(change, direction);
  const FieldSide& to = sideTo(change, direction);
  const auto whole = plan.applied.wholes.find(change.key);
  const bool replaced = whole != plan.applied.wholes.end();
  const NameBinding* now = replaced ? &sideTo(whole->second, direction).standing : find(change.key);
  const auto planned = plan.states.find(change.key);
  const ObjectState object = planned == plan.states.end() ? document.object(change.key) : planned->second;
  const bool stands = now && now->life == life;
  const bool goesHere = replaced && sideFrom(whole->second, direction).standing.life == life;
  if ((!stands && !goesHere) || life->writes[field] != from.write) {
    plan.skipped.push_back(stands ? fieldName(change.key, object, field) : change.key.name);
    return;
  }
  plan.applied.fields[{life, field}] = change;
  if (stands) plan.states[change.key] = withField(object, field, to.value);
}

void History::planGrid(const Step& step, UndoDirection direction, const Document& document, Plan& plan) const {
  if (!step.grid) return;
  if (gridWriteOf(document.gridRevision()) != sideFrom(*step.grid, direction).write) {
    plan.skipped.push_back(kGridField);
    return;
  }
  plan.applied.grid = step.grid;
  const Grid& grid = sideTo(*step.grid, direction).grid;
  plan.grid = {grid, !createdBeyond(step, direction, document, plan)};
}

/// Whether an object that the step's grid was to hold stays, beyond the grid that comes back: one created since, or one
/// of the step's own that is left as somebody else has made it. What was only moved there asks for no grid.
bool History::createdBeyond(const Step& step, UndoDirection direction, const Document& document,
                            const Plan& plan) const {
  const Bounds grid = sideTo(*step.grid, direction).grid.bounds();
  const std::uint64_t since = sideFrom(*step.grid, direction).write;
  for (const auto& [key, binding] : names_) {
    if (!binding.life || plan.states.contains(key)) continue;
    if (binding.write <= since && !step.wholes.contains(key)) continue;
    const Bounds bounds = boundsOf(document.object(key));
    if (bounds.empty()) continue;
    if (glm::any(glm::lessThan(bounds.min, grid.min)) || glm::any(glm::greaterThan(bounds.max, grid.max))) return true;
  }
  return false;
}

/// What the document has made of the grid: the one that was planned, a fit instead, or one that objects have asked for
/// that came back.
void History::recordRestoredGrid(UndoDirection direction, const Document& document, Plan& plan) {
  if (document.gridRevision() != document.revision()) return;
  const bool asPlanned = plan.grid && plan.grid->grid == document.grid();
  GridChange change;
  sideFrom(change, direction) = {gridWriteOf(document.gridRevisionBefore()), document.gridBefore()};
  sideTo(change, direction) = {asPlanned ? sideTo(*plan.applied.grid, direction).write : document.revision(),
                               document.grid()};
  gridWrite_ = {document.revision(), sideTo(change, direction).write};
  plan.applied.grid = change;
}

void History::done(const std::string& client, UndoDirection direction, Plan plan, const Document& document) {
  Member& member = members_[client];
  std::deque<Step>& from = direction == UndoDirection::kUndo ? member.undo : member.redo;
  std::deque<Step>& to = direction == UndoDirection::kUndo ? member.redo : member.undo;
  forget(from, true);
  member.grouping = false;
  recordRestoredGrid(direction, document, plan);
  for (const auto& [place, change] : plan.applied.fields) {
    place.first->writes[place.second] = sideTo(change, direction).write;
  }
  for (auto& [key, change] : plan.applied.wholes) {
    WholeSide& now = sideTo(change, direction);
    names_[key] = now.standing;
    if (now.standing.life) now.writes = now.standing.life->writes;
  }
  if (plan.applied.empty()) return;
  to.push_back(std::move(plan.applied));
  weigh(to.back(), 1);
  while (std::ssize(to) > limits_.maxUndoSteps) forget(to, false);
  forgetMuch();
}

}  // namespace lpv
