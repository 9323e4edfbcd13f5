#pragma once
// Undo as PROTOCOL.md says it, without objects, pointers or cleverness: every field is a cell with a number and the id
// of the write that put it there, every name a cell that says which object it stands for. A step is the list of its
// writes.

#include <algorithm>
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace lpv::test {

class UndoModel {
 public:
  explicit UndoModel(int depth) : depth_(depth) {}

  /// Lights and surfaces are called by their names, cameras "camera:NAME".
  struct Object {
    std::string kind;
    std::map<std::string, int> values;   ///< by field
    std::map<std::string, int> writers;
  };

  // An edit is begun, described write by write, and ended.
  void begin() {
    ++write_;
    writes_.clear();
    fit_.reset();
  }
  /// The edit has fitted the grid: another one is there now.
  void fitGrid(int grid) {
    fit_ = Fit{grid_, {grid, write_}};
    grid_ = fit_->after;
  }
  void create(const std::string& name, const std::string& kind, const std::map<std::string, int>& values) {
    Object object{kind, values, {}};
    for (const auto& [field, value] : values) object.writers[field] = write_;
    objects_.push_back(object);
    setName(name, int(objects_.size()) - 1);
  }
  void remove(const std::string& name) { setName(name, kNothing); }
  void set(const std::string& name, const std::string& field, int value) {
    const int id = names_[name].object;
    Object& object = objects_[std::size_t(id)];
    writes_.push_back({name, id, field, {object.values[field], object.writers[field]}, {value, write_}});
    object.values[field] = value;
    object.writers[field] = write_;
  }
  void end(const std::string& client, const std::string& group) {
    if (client.empty()) return;
    Member& member = members_[client];
    member.redo.clear();
    const bool joins = member.open && !group.empty() && !member.undo.empty() && member.undo.back().group == group;
    const bool wrote = !writes_.empty() || fit_;
    member.open = joins || wrote;
    if (!joins && !wrote) return;
    if (!joins) member.undo.push_back({group, {}, {}, {}});
    std::optional<Fit>& fit = member.undo.back().fit;
    if (fit && fit_) fit_->before = fit->before;
    if (fit_) fit = fit_;
    std::vector<Write>& step = member.undo.back().writes;
    step.insert(step.end(), writes_.begin(), writes_.end());
    if (int(member.undo.size()) > depth_) member.undo.pop_front();
  }
  void leave(const std::string& client) { members_.erase(client); }

  bool canUndo(const std::string& client) { return !members_[client].undo.empty(); }
  bool canRedo(const std::string& client) { return !members_[client].redo.empty(); }
  /// What is skipped.
  std::set<std::string> undo(const std::string& client) {
    Member& member = members_[client];
    return move(member, member.undo, member.redo, true);
  }
  std::set<std::string> redo(const std::string& client) {
    Member& member = members_[client];
    return move(member, member.redo, member.undo, false);
  }

  int grid() const { return grid_.value; }
  /// What was undone, or redone, last has fitted the grid instead of bringing one back.
  void fittedOnTheWay(const std::string& client, bool back, int grid) {
    Member& member = members_[client];
    std::deque<Step>& steps = back ? member.redo : member.undo;
    if (!moved_) steps.push_back({});
    const Side now = {grid, ++write_};
    steps.back().fit = back ? Fit{now, gridBefore_} : Fit{gridBefore_, now};
    grid_ = now;
  }

  std::map<std::string, const Object*> scene() const {
    std::map<std::string, const Object*> out;
    for (const auto& [name, cell] : names_) {
      if (cell.object != kNothing) out[name] = &objects_[std::size_t(cell.object)];
    }
    return out;
  }

 private:
  static constexpr int kNothing = -1;
  struct Side {
    int value = 0;
    int writer = 0;
  };
  /// Of a field, or of a name (`field` empty), whose value is an object.
  struct Write {
    std::string name;
    int object = kNothing;
    std::string field;
    Side before;
    Side after;
  };
  struct Fit {
    Side before;
    Side after;
  };
  struct Step {
    std::string group;
    std::vector<Write> writes;
    std::map<int, std::map<std::string, int>> left;  ///< writers of objects that the step's undo has brought back
    std::optional<Fit> fit = {};
  };
  struct Member {
    std::deque<Step> undo;
    std::deque<Step> redo;
    bool open = false;
  };
  struct Name {
    int object = kNothing;
    int writer = 0;
  };

  void setName(const std::string& name, int object) {
    Name& cell = names_[name];
    // What the edit has set before it removed the object comes back with the object.
    for (auto write = writes_.rbegin(); write != writes_.rend(); ++write) {
      if (write->name != name || write->field.empty()) continue;
      objects_[std::size_t(write->object)].values[write->field] = write->before.value;
      objects_[std::size_t(write->object)].writers[write->field] = write->before.writer;
    }
    std::erase_if(writes_, [&](const Write& write) { return write.name == name && !write.field.empty(); });
    // Several in one edit: only what the edit found and what it left can be seen.
    const auto same =
        std::find_if(writes_.begin(), writes_.end(), [&](const Write& write) { return write.name == name; });
    if (same != writes_.end()) {
      same->after = {object, write_};
    } else {
      writes_.push_back({name, kNothing, "", {cell.object, cell.writer}, {object, write_}});
    }
    cell = {object, write_};
  }

  /// One write per cell: from what the step found first to what it left last.
  static std::vector<Write> collapsed(const Step& step) {
    std::vector<Write> out;
    for (const Write& write : step.writes) {
      const auto same = std::find_if(out.begin(), out.end(), [&](const Write& each) {
        return each.name == write.name && each.object == write.object && each.field == write.field;
      });
      if (same == out.end()) {
        out.push_back(write);
      } else {
        same->after = write.after;
      }
    }
    return out;
  }

  /// Writers that the step knows an object to have had: its own writes, and what was there when it was brought back.
  bool untouched(const Step& step, int object, const std::string& field) const {
    const int writer = objects_[std::size_t(object)].writers.at(field);
    const auto left = step.left.find(object);
    if (left != step.left.end() && left->second.at(field) == writer) return true;
    for (const Write& write : step.writes) {
      if (write.field.empty() && write.after.value == object && write.after.writer == writer) return true;
      if (write.object == object && write.field == field && write.after.writer == writer) return true;
    }
    return false;
  }

  std::string called(const std::string& name, const std::string& field) const {
    const bool camera = name.starts_with("camera:");
    return camera ? name.substr(7) : field.empty() ? name : name + "." + field;
  }

  /// A step on its way to the other stack.
  struct Move {
    const Step& step;
    bool back = false;
    std::set<int> made = {};  ///< objects that the step has made: their fields come and go with them
    std::set<int> gone = {};  ///< that this move has removed
    std::set<std::string> skipped = {};
    Step moved = {};

    const Side& now(const Write& write) const { return back ? write.after : write.before; }
    const Side& then(const Write& write) const { return back ? write.before : write.after; }
  };

  void moveName(Move& move, const Write& write) {
    Name& cell = names_[write.name];
    const Side& now = move.now(write);
    if (cell.object != now.value || cell.writer != now.writer) {
      move.skipped.insert(called(write.name, ""));
      return;
    }
    if (now.value != kNothing) {
      bool mine = true;
      for (const auto& [field, writer] : objects_[std::size_t(now.value)].writers) {
        if (untouched(move.step, now.value, field)) continue;
        mine = false;
        move.skipped.insert(called(write.name, field));
      }
      if (!mine) return;
      move.gone.insert(now.value);
    }
    cell = {move.then(write).value, move.then(write).writer};
    move.moved.writes.push_back(write);
  }

  void moveField(Move& move, const Write& write) {
    if (!move.made.contains(write.object)) {
      Object& object = objects_[std::size_t(write.object)];
      const bool stands = names_[write.name].object == write.object;
      if ((!stands && !move.gone.contains(write.object)) || object.writers[write.field] != move.now(write).writer) {
        move.skipped.insert(called(write.name, stands ? write.field : ""));
        return;
      }
      object.writers[write.field] = move.then(write).writer;
      object.values[write.field] = move.then(write).value;
    }
    move.moved.writes.push_back(write);
  }

  /// Names first: what they bring back can then be written.
  std::set<std::string> move(Member& member, std::deque<Step>& from, std::deque<Step>& to, bool back) {
    member.open = false;
    const Step step = from.back();
    from.pop_back();
    Move move{step, back};
    for (const Write& write : step.writes) {
      if (write.field.empty() && write.after.value != kNothing) move.made.insert(write.after.value);
    }
    const std::vector<Write> all = collapsed(step);
    for (const Write& write : all) {
      if (write.field.empty()) moveName(move, write);
    }
    for (const Write& write : all) {
      if (!write.field.empty()) moveField(move, write);
    }
    finish(move);
    gridBefore_ = grid_;
    if (step.fit && grid_.writer != (back ? step.fit->after : step.fit->before).writer) {
      move.skipped.insert("session.grid");
    } else if (step.fit) {
      grid_ = back ? step.fit->before : step.fit->after;
      move.moved.fit = step.fit;
    }
    moved_ = !move.moved.writes.empty() || move.moved.fit;
    if (moved_) to.push_back(move.moved);
    return move.skipped;
  }

  /// The fields of an object that is left standing are nothing to move the other way.
  void finish(Move& move) {
    std::set<int> whole;
    for (const Write& write : move.moved.writes) {
      if (!write.field.empty()) continue;
      whole.insert(write.after.value);
      const int object = move.then(write).value;
      if (object != kNothing) move.moved.left[object] = objects_[std::size_t(object)].writers;
    }
    std::erase_if(move.moved.writes, [&](const Write& write) {
      return !write.field.empty() && move.made.contains(write.object) && !whole.contains(write.object);
    });
  }

  const int depth_;
  int write_ = 0;
  std::vector<Write> writes_;
  std::optional<Fit> fit_;   ///< of the edit that is made
  Side grid_;
  Side gridBefore_;          ///< what was undone or redone last
  bool moved_ = false;       ///< that has left a step on the other stack
  std::vector<Object> objects_;
  std::map<std::string, Name> names_;
  std::map<std::string, Member> members_;
};

}  // namespace lpv::test
