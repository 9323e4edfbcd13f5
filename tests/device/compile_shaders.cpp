// Gives every recorded shader variant (LPV_SHADER_RECORD) to the driver, each linked as a program of its own, and says
// which it refuses and which take it longest. A process for each core, since drivers compile on one thread.
//   compile_shaders FOLDER

#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "gpu/context.h"
#include "gpu/device.h"
#include "gpu/gl.h"

namespace {

using namespace lpv;
namespace fs = std::filesystem;

constexpr std::size_t kSlowest = 12;  ///< how many are named

const std::map<std::string, GLenum> kStages = {{".comp", GL_COMPUTE_SHADER},
                                               {".vert", GL_VERTEX_SHADER},
                                               {".geom", GL_GEOMETRY_SHADER},
                                               {".frag", GL_FRAGMENT_SHADER}};

struct Outcome {
  double seconds = 0.0;
  std::string message;  ///< empty: taken
};

std::string textOf(const fs::path& file) {
  std::ostringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return text.str();
}

/// The text with what programs of a single stage have to declare besides (ARB_separate_shader_objects).
std::string separable(const fs::path& file) {
  std::string text = textOf(file);
  const std::string block = "gl_PerVertex { vec4 gl_Position; }";
  const std::string stage = file.extension().string();
  const std::string declared = stage == ".vert"   ? "out " + block + ";\n"
                               : stage == ".geom" ? "in " + block + " gl_in[];\nout " + block + ";\n"
                                                  : "";
  return text.insert(text.find('\n') + 1, declared);
}

/// One line of what the driver says.
std::string logOf(GLuint object, bool program) {
  std::array<char, 2048> log{};
  if (program) {
    glGetProgramInfoLog(object, GLsizei(log.size()), nullptr, log.data());
  } else {
    glGetShaderInfoLog(object, GLsizei(log.size()), nullptr, log.data());
  }
  std::string line = log.data();
  std::replace(line.begin(), line.end(), '\n', ' ');
  return line.empty() ? "refused without a word" : line;
}

Outcome outcomeOf(const fs::path& file) {
  const auto begin = std::chrono::steady_clock::now();
  const std::string text = separable(file);
  const char* const source = text.c_str();
  const GLuint shader = glCreateShader(kStages.at(file.extension().string()));
  glShaderSource(shader, 1, &source, nullptr);
  glCompileShader(shader);
  GLint done = GL_FALSE;
  glGetShaderiv(shader, GL_COMPILE_STATUS, &done);
  Outcome outcome;
  if (done != GL_TRUE) outcome.message = logOf(shader, false);
  const GLuint program = glCreateProgram();
  if (done == GL_TRUE) {
    glProgramParameteri(program, GL_PROGRAM_SEPARABLE, GL_TRUE);
    glAttachShader(program, shader);
    glLinkProgram(program);
    glGetProgramiv(program, GL_LINK_STATUS, &done);
    if (done != GL_TRUE) outcome.message = logOf(program, true);
  }
  glDeleteProgram(program);
  glDeleteShader(shader);
  outcome.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return outcome;
}

/// Every `of`-th variant, from `first` on; a line "name, seconds, message" each into `out`.
int compileShare(const std::vector<fs::path>& files, std::size_t first, std::size_t of, const fs::path& out) {
  for (const gpu::Device& device : gpu::preferredOrder(gpu::listDevices())) {
    const Expected<gpu::Context> context = gpu::Context::make(device);
    if (!context.ok()) continue;
    std::ofstream lines(out);
    for (std::size_t i = first; i < files.size(); i += of) {
      const Outcome outcome = outcomeOf(files[i]);
      lines << files[i].filename().string() << '\t' << outcome.seconds << '\t' << outcome.message << std::endl;
    }
    return 0;
  }
  std::fprintf(stderr, "compile_shaders: no OpenGL 4.5; lpvd --list-devices says why\n");
  return 1;
}

std::vector<fs::path> variantsIn(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (kStages.contains(entry.path().extension().string())) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

struct Line {
  std::string name;
  Outcome outcome;
};

/// Says which were refused and which took longest; whether none was refused.
bool tell(std::vector<Line> lines) {
  bool taken = true;
  for (const Line& line : lines) {
    if (line.outcome.message.empty()) continue;
    taken = false;
    std::printf("refused: %s: %s\n", line.name.c_str(), line.outcome.message.c_str());
  }
  std::sort(lines.begin(), lines.end(),
            [](const Line& a, const Line& b) { return a.outcome.seconds > b.outcome.seconds; });
  lines.resize(std::min(lines.size(), kSlowest));
  for (const Line& line : lines) std::printf("%6.2f s  %s\n", line.outcome.seconds, line.name.c_str());
  return taken;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2 || !fs::is_directory(argv[1])) {
    std::fprintf(stderr,
                 "usage: compile_shaders FOLDER: what LPV_SHADER_RECORD=FOLDER left of a run of the gpu tests\n");
    return 2;
  }
  const std::vector<fs::path> files = variantsIn(argv[1]);
  const std::size_t processes = std::max(1U, std::thread::hardware_concurrency());
  std::vector<fs::path> parts;
  for (std::size_t i = 0; i < processes; ++i) {
    parts.push_back(fs::temp_directory_path() /
                    ("compile_shaders." + std::to_string(getpid()) + "." + std::to_string(i)));
    if (fork() == 0) _exit(compileShare(files, i, processes, parts.back()));
  }
  while (wait(nullptr) > 0) {
  }
  std::vector<Line> lines;
  for (const fs::path& part : parts) {
    std::ifstream in(part);
    for (std::string name, seconds, message;
         std::getline(in, name, '\t') && std::getline(in, seconds, '\t') && std::getline(in, message);) {
      lines.push_back({name, {std::stod(seconds), message}});
    }
    fs::remove(part);
  }
  double sum = 0.0;
  for (const Line& line : lines) sum += line.outcome.seconds;
  std::printf("%zu variants, %zu seen to the end, %.0f s of compilation\n", files.size(), lines.size(), sum);
  const bool all = !files.empty() && lines.size() == files.size();
  return tell(std::move(lines)) && all ? 0 : 1;
}
