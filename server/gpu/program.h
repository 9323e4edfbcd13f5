#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "gpu/loop_guard.h"
#include "gpu/shader_source.h"

namespace lpv::gpu {

/// A linked program: one compute stage, or a vertex, perhaps a geometry and a fragment stage. Everything it reads comes
/// through bindings of shaders/layout.h, so there are no uniforms to set by name. Labelled; move-only; empty (id 0)
/// after move.
class Program {
 public:
  Program() = default;
  /// Compiles and links shaders/`files` (stage from the ending: .comp, .vert, .geom, .frag) with `defines`. Throws
  /// Failure (INTERNAL) with the compiler's messages.
  Program(std::vector<std::string> files, Defines defines);
  /// A compute program of a text that no file holds (tests); it may #include shaders/.
  static Program computeOfText(const std::string& name, const std::string& text, const Defines& defines);
  Program(Program&& other) noexcept;
  Program& operator=(Program&& other) noexcept;
  ~Program();

  std::uint32_t id() const { return id_; }
  explicit operator bool() const { return id_ != 0; }

  /// Makes it current. Development builds recompile it when a source has changed on disk; they keep the old program,
  /// with the messages in the log, when the new one does not compile.
  void use();
  /// use() and dispatch this many work-groups; nothing for an empty count.
  void dispatch(std::uint32_t x, std::uint32_t y = 1, std::uint32_t z = 1);
  /// use() and dispatch as `arguments` at byte `offset` say (3 uints); the buffer is bound by the caller.
  void dispatchIndirect(std::size_t offset);
  /// Of a compute program, under LPV_LOOP_GUARD=1: threads whose loops the driver has ended since it was asked last.
  std::uint32_t loopsEnded() { return loops_.ended(); }

 private:
  void reloadIfChanged();

  std::uint32_t id_ = 0;
  LoopGuard loops_;
  std::vector<std::string> entries_;
  Defines defines_;
  std::vector<std::string> sources_;  ///< all files, includes too
  std::size_t stamp_ = 0;
};

/// Makes what shaders have written visible to every later command.
void memoryBarrier();

/// The variants of one source, each compiled at its first use.
class ProgramVariants {
 public:
  explicit ProgramVariants(std::vector<std::string> files) : files_(std::move(files)) {}
  /// Throws Failure when the variant does not compile.
  Program& get(const Defines& defines);

 private:
  std::vector<std::string> files_;
  std::map<Defines, Program> programs_;
};

/// The same, where a variant is a value of a plain struct: its `defines()` say what its members are called in the
/// shader. Those that were asked for are known by their values: no text is made of them again.
template <typename Variant>
class Programs {
 public:
  explicit Programs(std::vector<std::string> files) : programs_(std::move(files)) {}
  Program& get(const Variant& variant) {
    for (const auto& [known, program] : known_) {
      if (known == variant) return *program;
    }
    Program& program = programs_.get(variant.defines());
    known_.emplace_back(variant, &program);
    return program;
  }

 private:
  ProgramVariants programs_;  ///< a map, so that programs stay where they are
  std::vector<std::pair<Variant, Program*>> known_;
};

/// A define with a number, or 0 or 1.
inline Defines::value_type define(const char* name, int value) { return {name, std::to_string(value)}; }

}  // namespace lpv::gpu
