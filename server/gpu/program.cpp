#include "gpu/program.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <array>
#include <utility>

#include "gpu/failure.h"
#include "gpu/gl.h"
#include "gpu/shader_record.h"
#include "gpu/usage.h"

namespace lpv::gpu {

namespace {

struct Shader {
  explicit Shader(GLenum stage) : id(glCreateShader(stage)) {}
  Shader(const Shader&) = delete;
  Shader& operator=(const Shader&) = delete;
  ~Shader() { glDeleteShader(id); }
  GLuint id;
};

GLenum stageOf(const std::string& file) {
  if (file.ends_with(".comp")) return GL_COMPUTE_SHADER;
  if (file.ends_with(".vert")) return GL_VERTEX_SHADER;
  if (file.ends_with(".geom")) return GL_GEOMETRY_SHADER;
  if (file.ends_with(".frag")) return GL_FRAGMENT_SHADER;
  throw Failure(Code::kInternal, "the file extension names no shader stage: " + file);
}

/// Appends a legend of file numbers, because the compiler's messages number files as #line does.
std::string describe(const std::string& log, const std::vector<std::string>& files) {
  std::string text = log;
  for (std::size_t i = 0; i < files.size(); ++i) text += "\n  " + std::to_string(i) + " = " + files[i];
  return text;
}

/// One shader of a program; the file's extension names its stage.
struct Stage {
  std::string file;
  ShaderSource source;
};

void compile(const Shader& shader, const std::string& file, const ShaderSource& source) {
  const std::string guarded = file.ends_with(".comp") ? LoopGuard::guarded(source.text) : source.text;
  const char* text = guarded.c_str();
  glShaderSource(shader.id, 1, &text, nullptr);
  glCompileShader(shader.id);
  GLint compiled = 0;
  glGetShaderiv(shader.id, GL_COMPILE_STATUS, &compiled);
  if (compiled == GL_TRUE) return recordShader(file, source.text);
  std::array<char, 4096> log{};
  glGetShaderInfoLog(shader.id, GLsizei(log.size()), nullptr, log.data());
  throw Failure(Code::kInternal, file + " does not compile: " + describe(log.data(), source.files));
}

void link(GLuint program, const std::string& name) {
  glLinkProgram(program);
  GLint linked = 0;
  glGetProgramiv(program, GL_LINK_STATUS, &linked);
  if (linked == GL_TRUE) return;
  std::array<char, 4096> log{};
  glGetProgramInfoLog(program, GLsizei(log.size()), nullptr, log.data());
  throw Failure(Code::kInternal, name + " does not link: " + log.data());
}

GLuint build(const std::vector<Stage>& stages, const std::string& name) {
  const GLuint program = glCreateProgram();
  try {
    for (const Stage& stage : stages) {
      const Shader shader(stageOf(stage.file));
      compile(shader, stage.file, stage.source);
      glAttachShader(program, shader.id);
    }
    link(program, name);
  } catch (...) {
    glDeleteProgram(program);
    throw;
  }
  glObjectLabel(GL_PROGRAM, program, GLsizei(std::min<std::size_t>(name.size(), 200)), name.c_str());
  return program;
}

std::string nameOf(const std::vector<std::string>& entries, const Defines& defines) {
  std::string name = entries.front();
  for (const auto& [key, value] : defines) name += " " + key + "=" + value;
  return name;
}

}  // namespace

Program::Program(std::vector<std::string> files, Defines defines)
    : entries_(std::move(files)), defines_(std::move(defines)) {
  std::vector<Stage> stages;
  for (const std::string& file : entries_) {
    stages.push_back({file, assembleShader(file, defines_)});
    sources_.insert(sources_.end(), stages.back().source.files.begin(), stages.back().source.files.end());
  }
  id_ = build(stages, nameOf(entries_, defines_));
  loops_ = LoopGuard(nameOf(entries_, defines_));
  stamp_ = sourceStamp(sources_);
}

Program Program::computeOfText(const std::string& name, const std::string& text, const Defines& defines) {
  Program program;
  program.id_ = build({{name + ".comp", assembleText(name, text, defines)}}, name);
  program.loops_ = LoopGuard(name);
  return program;
}

Program::Program(Program&& other) noexcept
    : id_(std::exchange(other.id_, 0)),
      loops_(std::move(other.loops_)),
      entries_(std::move(other.entries_)),
      defines_(std::move(other.defines_)),
      sources_(std::move(other.sources_)),
      stamp_(other.stamp_) {}

Program& Program::operator=(Program&& other) noexcept {
  Program taken(std::move(other));
  std::swap(id_, taken.id_);
  std::swap(loops_, taken.loops_);
  std::swap(entries_, taken.entries_);
  std::swap(defines_, taken.defines_);
  std::swap(sources_, taken.sources_);
  std::swap(stamp_, taken.stamp_);
  return *this;
}

Program::~Program() {
  if (id_ != 0) glDeleteProgram(id_);
}

void Program::reloadIfChanged() {
  const std::size_t stamp = sourceStamp(sources_);
  if (stamp == stamp_) return;
  stamp_ = stamp;
  try {
    *this = Program(entries_, defines_);
    spdlog::info("reloaded {}", nameOf(entries_, defines_));
  } catch (const Failure& failure) {
    spdlog::error("kept the old program: {}", failure.what());
  }
}

void Program::use() {
  reloadIfChanged();
  glUseProgram(id_);
}

void Program::dispatch(std::uint32_t x, std::uint32_t y, std::uint32_t z) {
  if (x == 0 || y == 0 || z == 0) return;
  usage().dispatches++;
  use();
  loops_.bind();
  glDispatchCompute(x, y, z);
}

void Program::dispatchIndirect(std::size_t offset) {
  usage().dispatches++;
  use();
  loops_.bind();
  glDispatchComputeIndirect(GLintptr(offset));
}

void memoryBarrier() { glMemoryBarrier(GL_ALL_BARRIER_BITS); }

Program& ProgramVariants::get(const Defines& defines) {
  const auto found = programs_.find(defines);
  if (found != programs_.end()) return found->second;
  return programs_.emplace(defines, Program(files_, defines)).first->second;
}

}  // namespace lpv::gpu
