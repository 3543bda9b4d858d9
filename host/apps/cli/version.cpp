#include "apps/cli/version.h"

#include <fmt/format.h>

#include <string_view>

#include "build_facts.h"
#include "commit.h"
#include "scene/import/load.h"

namespace kdray::cli {

namespace {

std::string line(std::string_view name, std::string_view text) {
  return text.empty() ? "" : fmt::format("{:<10}{}\n", name, text);
}

// "JPEG pictures; no WebP pictures"
std::string formats() {
  std::string text;
  for (const scene::Ability& a : scene::abilities())
    text += fmt::format("{}{}{}", text.empty() ? "" : "; ", a.here ? "" : "no ", a.what);
  return text;
}

}  // namespace

std::string version_text() {
  const std::string_view commit = KDRAY_COMMIT, mpi = KDRAY_MPI, page = KDRAY_PAGE;
  return "kdray " KDRAY_VERSION "\n" +
         line("commit", commit.empty() ? "" : fmt::format("{} of {}", commit, KDRAY_COMMIT_DATE)) +
         line("compiler", KDRAY_COMPILER ", " KDRAY_BUILD_TYPE ", " KDRAY_PROCESSOR KDRAY_SANITIZERS) +
         line("OpenCL", "headers " KDRAY_OPENCL_HEADERS
                        "; PoCL and other drivers are found when it runs: kdray devices") +
         line("MPI", mpi == "ON" ? "libkdray-mpi.so was built" : "none: MPI was missing") +
         line("page", page == "ON" ? "kdray view is there" : "none: Boost or libjpeg-turbo was missing") +
         line("reads", formats());
}

std::string commit_date() {
  return KDRAY_COMMIT_DATE;
}

}  // namespace kdray::cli
