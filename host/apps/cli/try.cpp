#include "apps/cli/try.h"

#include <span>
#include <string>

#include "apps/cli/self_test.h"
#include "probe/trial/program.h"
#include "probe/trial/request.h"

namespace kdray::cli {

void try_if_asked(int argc, char** argv) {
  trial::this_program_tries();
  if (const auto request = trial::request_of({argv, static_cast<std::size_t>(argc)}))
    trial::try_it(*request, [](int number) { return self_test(std::to_string(number)); });
}

}  // namespace kdray::cli
