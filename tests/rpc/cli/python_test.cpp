// client/python/drag_lamp.py over the installed package, against a real server: what the example says is true of it.
// The package's own tests are in client/python/tests.

#include <gtest/gtest.h>

#include <cctype>
#include <cstdlib>
#include <filesystem>
#include <sstream>

#include "rpc/support/rpc.h"
#include "rpc/support/server_process.h"

namespace lpv::rpc {
namespace {

/// What the example prints.
struct Printed {
  int edits = 0, refused = 0, reconnections = 0, volumes = 0;
  std::uint64_t revision = 0;
  double brightestX = 0.0;
  double start = 0.0, end = 0.0;              ///< W/m^2 on the floor below
  double startUndone = 0.0, endUndone = 0.0;
};

/// The numbers of a text in order, whatever stands between them.
std::vector<double> numbersIn(std::string text) {
  for (char& c : text)
    if (!std::isdigit(static_cast<unsigned char>(c)) && c != '.' && c != '-') c = ' ';
  std::istringstream words(text);
  std::vector<double> out;
  for (std::string word; words >> word;) {
    char* rest = nullptr;
    const double number = std::strtod(word.c_str(), &rest);
    if (rest != word.c_str()) out.push_back(number);
  }
  return out;
}

Printed parse(const std::string& text) {
  // edits, refused, reconnections, revision; volumes, KiB, x; start, end, "/m^2"; both undone, "/m^2"
  const std::vector<double> n = numbersIn(text);
  EXPECT_EQ(n.size(), 13U) << text;
  if (n.size() != 13U) return {};
  return {int(n[0]), int(n[1]), int(n[2]), int(n[4]), std::uint64_t(n[3]), n[6], n[7], n[8], n[10], n[11]};
}

class PythonTest : public ::testing::Test {
 protected:
  ~PythonTest() override {
    std::error_code ignored;
    std::filesystem::remove_all(directory_, ignored);
  }
  std::unique_ptr<ServerProcess> serve(const std::string& listen = "127.0.0.1:0") const {
    return std::make_unique<ServerProcess>(std::vector<std::string>{"--state-dir", directory_}, listen);
  }
  static std::unique_ptr<ChildProcess> drag(const ServerProcess& server, const std::string& seconds) {
    setenv("PYTHONDONTWRITEBYTECODE", "1", 1);
    return std::make_unique<ChildProcess>(
        PYTHON_WITH_LPV, std::vector<std::string>{PYTHON_EXAMPLE, "--server", server.address(), "--seconds", seconds});
  }
  static Printed finish(ChildProcess& example) {
    EXPECT_EQ(example.wait(std::chrono::seconds(120)), 0) << example.output() << example.errors();
    return parse(example.output());
  }

 private:
  const std::string directory_ = makeDirectory();
};

// The lamp goes from x = -1.5 to 1.5 m, and back as one undo step.
// Broken by: no undo group.
TEST_F(PythonTest, TheExampleDragsALampAndSeesItsLight) {
  const auto server = serve();
  const auto example = drag(*server, "1");
  const Printed printed = finish(*example);
  EXPECT_EQ(printed.edits, 60);
  EXPECT_EQ(printed.refused, 0);
  EXPECT_EQ(printed.reconnections, 0);
  EXPECT_EQ(printed.revision, 61U) << "the room, and an edit a step";
  EXPECT_GE(printed.volumes, 1);
  EXPECT_NEAR(printed.brightestX, 1.5, 0.2);
  EXPECT_GT(printed.end, 5.0 * printed.start);
  EXPECT_DOUBLE_EQ(printed.startUndone, printed.end);
  EXPECT_DOUBLE_EQ(printed.endUndone, printed.start);
}

// Every edit arrives once, whatever becomes of the server meanwhile.
// Broken by: unacknowledged edits forgotten with the connection.
TEST_F(PythonTest, TheExampleSurvivesAServerThatIsKilled) {
  auto server = serve();
  const auto example = drag(*server, "3");
  {
    Stubs stubs(server->address());
    ASSERT_TRUE(eventually([&] {
      pb::ListSessionsResponse sessions;
      return stubs.session->ListSessions(Call(), {}, &sessions).ok() && sessions.sessions_size() == 1 &&
             sessions.sessions(0).revision() > 20;
    }));
  }
  const std::string address = server->address();
  server->process().signal(SIGKILL);
  server.reset();
  server = serve(address);
  const Printed printed = finish(*example);
  EXPECT_EQ(printed.edits, 180);
  EXPECT_EQ(printed.refused, 0);
  EXPECT_GE(printed.reconnections, 1);
  EXPECT_EQ(printed.revision, 181U);
  EXPECT_NEAR(printed.brightestX, 1.5, 0.2);
}

}  // namespace
}  // namespace lpv::rpc
