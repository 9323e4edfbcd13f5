// What edits write, as steps.
#include "session/document/history.h"

#include <algorithm>
#include <iterator>
#include <type_traits>
#include <variant>

namespace lpv {

std::map<ObjectKey, History::FieldsWritten> History::touches(const Edit& edit, const std::vector<std::string>& names,
                                                             const Document& document) {
  std::map<ObjectKey, FieldsWritten> out;
  for (std::size_t i = 0; i < edit.operations.size(); ++i) {
    const auto touch = [&](bool camera) -> FieldsWritten& { return out[{camera, names[i]}]; };
    std::visit(
        [&](const auto& op) {
          using Op = std::decay_t<decltype(op)>;
          if constexpr (std::is_same_v<Op, UpdateLight> || std::is_same_v<Op, UpdateSurface>) {
            touch(false).fields |= fieldsIn(op.fields);
          } else if constexpr (std::is_same_v<Op, SetVertices>) {
            touch(false).fields.set(kMeshField);
          } else if constexpr (std::is_same_v<Op, PutCamera>) {
            touch(true).fields.set(0);
          } else if constexpr (std::is_same_v<Op, DeleteCamera>) {
            touch(true).whole = true;
          } else if constexpr (!std::is_same_v<Op, FitGrid>) {
            touch(false).whole = true;
          }
        },
        edit.operations[i]);
  }
  for (auto& [key, touch] : out) touch.whole = touch.whole || !document.objectBefore(key).stands();
  return out;
}

/// What has the name; an object that was there before this history began gets its life here.
History::NameBinding& History::standing(const ObjectKey& key, bool stands) {
  const auto [found, isNew] = names_.try_emplace(key);
  if (isNew && stands) found->second.life = std::make_shared<ObjectIncarnation>();
  return found->second;
}

const History::NameBinding* History::find(const ObjectKey& key) const {
  const auto found = names_.find(key);
  return found == names_.end() ? nullptr : &found->second;
}

void History::recordWrites(const std::string& client, const Edit& edit, const std::vector<std::string>& names,
                           const Document& document) {
  Step step;
  step.group = edit.undoGroup;
  for (const auto& [key, touch] : touches(edit, names, document)) {
    if (touch.whole) {
      recordObject(key, document, step);
    } else {
      recordFields(key, touch.fields, document, step);
    }
  }
  recordGrid(document, step);
  if (!client.empty()) push(client, std::move(step));
  forgetNames();
}

void History::recordObject(const ObjectKey& key, const Document& document, Step& step) {
  const ObjectState before = document.objectBefore(key);
  NameBinding& now = standing(key, before.stands());
  WholeChange& change = step.wholes[key];
  change.before = {now, now.life ? now.life->writes : Writes(), before};
  now.life = document.object(key).stands() ? std::make_shared<ObjectIncarnation>() : nullptr;
  now.write = document.revision();
  if (now.life) now.life->writes.fill(document.revision());
  change.after = {now, now.life ? now.life->writes : Writes(), {}};
}

void History::recordFields(const ObjectKey& key, const FieldSet& fields, const Document& document, Step& step) {
  const ObjectState before = document.objectBefore(key);
  const ObjectState after = document.object(key);
  const IncarnationPtr& life = standing(key, true).life;
  for (std::size_t field = 0; field < fieldCount(after); ++field) {
    if (!fields[field]) continue;
    FieldChange& change = step.fields[{life, field}];
    change.key = key;
    change.before = {life->writes[field], fieldOf(before, field)};
    change.after = {document.revision(), fieldOf(after, field)};
    life->writes[field] = document.revision();
  }
}

/// The write that a grid of this revision of the document goes back to: what no edit has brought back is a write
/// itself.
std::uint64_t History::gridWriteOf(std::uint64_t revision) const {
  return gridWrite_.revision == revision ? gridWrite_.write : revision;
}

void History::recordGrid(const Document& document, Step& step) {
  if (document.gridRevision() != document.revision()) return;
  step.grid = {{gridWriteOf(document.gridRevisionBefore()), document.gridBefore()},
               {document.revision(), document.grid()}};
  gridWrite_ = {document.revision(), document.revision()};
}

void History::push(const std::string& client, Step step) {
  Member& member = members_[client];
  while (!member.redo.empty()) forget(member.redo, true);
  const bool joins =
      member.grouping && !step.group.empty() && !member.undo.empty() && member.undo.back().group == step.group;
  member.grouping = true;
  if (joins) {
    weigh(member.undo.back(), -1);
    merge(member.undo.back(), std::move(step));
  } else {
    // A step without anything to take back ends a group as any other does; it is not kept.
    if (step.empty()) {
      member.grouping = false;
      return;
    }
    step.number = ++lastNumber_;
    member.undo.push_back(std::move(step));
  }
  weigh(member.undo.back(), 1);
  while (std::ssize(member.undo) > limits_.maxUndoSteps) forget(member.undo, false);
  forgetMuch();
}

/// What was there before is what the first edit of a group found, what is left what the last one wrote.
void History::merge(Step& into, Step step) {
  if (step.grid && into.grid) step.grid->before = into.grid->before;
  if (step.grid) into.grid = step.grid;
  for (auto& [key, change] : step.wholes) {
    const auto [found, isNew] = into.wholes.try_emplace(key, std::move(change));
    if (!isNew) found->second.after = std::move(change.after);
  }
  for (auto& [place, change] : step.fields) {
    const auto& [life, field] = place;
    const auto whole = into.wholes.find(change.key);
    if (whole != into.wholes.end() && whole->second.after.standing.life == life) {
      // The group made this object: taken back, it goes as a whole.
      whole->second.after.writes[field] = change.after.write;
      continue;
    }
    const auto [found, isNew] = into.fields.try_emplace(place, std::move(change));
    if (!isNew) found->second.after = std::move(change.after);
  }
}

void History::leave(const std::string& client) {
  const auto found = members_.find(client);
  if (found == members_.end()) return;
  while (!found->second.undo.empty()) forget(found->second.undo, true);
  while (!found->second.redo.empty()) forget(found->second.redo, true);
  members_.erase(found);
}

std::size_t History::depth(const std::string& client) const {
  const auto found = members_.find(client);
  return found == members_.end() ? 0 : found->second.undo.size();
}

namespace {

/// What a change takes besides meshes and textures, bytes, about.
constexpr std::int64_t kChangeBytes = 512;

}  // namespace

void History::hold(const BlobHash& hash, std::int64_t bytes, int sign) {
  HeldBlob& held = held_[hash];
  if (held.uses == 0) {
    held.bytes = bytes;
    bytes_ += bytes;
  }
  held.uses += sign;
  if (held.uses != 0) return;
  bytes_ -= held.bytes;
  held_.erase(hash);
}

void History::hold(const FieldValue& value, int sign) {
  if (const auto* mesh = std::get_if<MeshPtr>(&value)) hold((*mesh)->hash, std::int64_t((*mesh)->bytes()), sign);
  const auto* texture = std::get_if<TexturePtr>(&value);
  if (texture && *texture) hold((*texture)->hash, std::int64_t((*texture)->texels.size()), sign);
}

void History::hold(const ObjectState& object, int sign) {
  if (object.light) {
    hold(object.light->mesh, sign);
    hold(object.light->texture, sign);
  }
  if (object.surface) {
    hold(object.surface->mesh, sign);
    for (const TexturePtr& texture : texturesOf(*object.surface)) hold(texture, sign);
  }
}

/// Counts a step that comes (1) or goes (-1).
void History::weigh(const Step& step, int sign) {
  bytes_ += sign * kChangeBytes * std::int64_t(step.wholes.size() + step.fields.size() + (step.grid ? 1 : 0));
  for (const auto& [key, change] : step.wholes) {
    hold(change.before.object, sign);
    hold(change.after.object, sign);
  }
  for (const auto& [place, change] : step.fields) {
    hold(change.before.value, sign);
    hold(change.after.value, sign);
  }
}

void History::forget(std::deque<Step>& steps, bool newest) {
  weigh(newest ? steps.back() : steps.front(), -1);
  if (newest) {
    steps.pop_back();
  } else {
    steps.pop_front();
  }
}

/// Steps go, the session's oldest first, while all of them together are too large.
void History::forgetMuch() {
  while (bytes_ > limits_.maxUndoBytes) {
    std::deque<Step>* oldest = nullptr;
    for (auto& [client, member] : members_) {
      // Of what was taken back, the front is what would be made again last.
      for (std::deque<Step>* steps : {&member.undo, &member.redo}) {
        if (steps->empty()) continue;
        if (!oldest || steps->front().number < oldest->front().number) oldest = steps;
      }
    }
    if (!oldest) return;
    forget(*oldest, false);
  }
}

/// Names that nothing stands under and no step knows; once in a while, as there may be any number.
void History::forgetNames() {
  if (names_.size() < forgetNamesAt_) return;
  std::set<ObjectKey> known;
  for (const auto& [client, member] : members_) {
    for (const auto* steps : {&member.undo, &member.redo}) {
      for (const Step& step : *steps) {
        for (const auto& [key, change] : step.wholes) known.insert(key);
      }
    }
  }
  std::erase_if(names_, [&](const auto& entry) { return !entry.second.life && !known.contains(entry.first); });
  forgetNamesAt_ = 2 * names_.size() + 10'000;
}

void History::addHashesInUse(std::set<BlobHash>& out) const {
  for (const auto& [hash, held] : held_) out.insert(hash);
}

}  // namespace lpv
