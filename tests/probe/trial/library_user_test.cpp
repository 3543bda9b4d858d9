// What    Drivers that fail in a program that has kdray as a library (library_user.cpp), with the program
//         kdray to try them and without it.
#include "probe/trial/failing_driver.h"

#include <signal.h>

namespace kdray::test {
namespace {

// Whoever uses the library has another program, which can't try anything.
class LibraryUser : public DriversThatFail {
 protected:
  Outcome use(const std::string& wrong, const std::string& program) const {
    return run(
        {folder_ / "cache" / "programs"},
        {.program = LIBRARY_USER, .environment = {{"FAKE_DRIVER", wrong}, {"KDRAY_PROGRAM", program}}});
  }
};

TEST_F(LibraryUser, IsServedByKdray) {
  const Outcome first = use("crash-build", KDRAY_PROGRAM);
  ASSERT_TRUE(succeeds(first));
  EXPECT_NE(first.out.find("Fake device: Fake device crashes (SIGSEGV)"), std::string::npos) << first.out;
  EXPECT_NE(first.out.find(": usable"), std::string::npos) << first.out;
  EXPECT_EQ(use("crash-build", "/none").out, first.out) << "what is known needs no program";
}

TEST_F(LibraryUser, ProgramsThatAreNotKdrayGiveNoVerdict) {
  for (const char* const program : {"/bin/true", "/bin/false", "/bin/cat"}) {
    const Outcome refused = use("refuse-build", program);
    ASSERT_TRUE(succeeds(refused));
    EXPECT_NE(refused.out.find("the device's compiler refuses"), std::string::npos) << refused.out;
  }
}

TEST_F(LibraryUser, WithoutAProgramItIsSurvivedTheSecondTime) {
  EXPECT_EQ(use("crash-build", "/none").signal, SIGSEGV);
  const Outcome second = use("crash-build", "/none");
  ASSERT_TRUE(succeeds(second));
  EXPECT_NE(second.out.find("has ended or held up a program that tested it"), std::string::npos)
      << second.out;
}

}  // namespace
}  // namespace kdray::test
