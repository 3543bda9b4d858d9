// What    kdray generate: Haines' scenes as NFF files, at any size.
#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <iostream>
#include <memory>
#include <string>

#include "apps/cli/command.h"
#include "apps/cli/options.h"
#include "apps/cli/output.h"
#include "apps/cli/run_files.h"
#include "base/error.h"
#include "base/write_file.h"
#include "scene/generate/generate.h"

namespace kdray::cli {

namespace {

constexpr int kSizeMax = 1'000'000'000;  // each generator has a limit of its own below this

struct GenerateArgs {
  std::string name, output;
  int size = -1;  // < 0: the generator's own
};

std::string what_there_is() {
  std::string text = "The scenes, with their usual size:";
  for (const generate::Generator& g : generate::generators())
    text += fmt::format("\n  {:<10} {:>4}  {}", g.name, g.default_size, g.description);
  return text;
}

std::string names() {
  std::vector<std::string_view> all;
  for (const generate::Generator& g : generate::generators()) all.push_back(g.name);
  return shape_of(all);
}

// An unknown name has no size of its own; generate() refuses it with the list of what there is.
int default_size(const std::string& name) {
  for (const generate::Generator& g : generate::generators())
    if (g.name == name) return g.default_size;
  return 1;
}

void write(const GenerateArgs& o, int size, std::ostream& out, const std::string& where) {
  generate::generate(o.name, size, out);
  out.flush();
  if (!out) throw input_error(where, 0, "can't be written", "is the disk full?");
}

// A scene of another ending would be read as what it isn't. Devices and pipes need no ending.
void check_is_nff(const std::filesystem::path& output) {
  std::error_code error;
  const std::string ending = ending_of(output);
  if (ending == ".nff" || std::filesystem::is_other(output, error)) return;
  if (ending == ".gz" || ending == ".xz")
    throw input_error(output.string(), 0, "generate writes plain text",
                      "leave " + ending + " off and compress it after");
  throw input_error(output.string(), 0, "generate writes NFF", "end the name in .nff");
}

int run(const GenerateArgs& o) {
  const int size = o.size < 0 ? default_size(o.name) : o.size;
  if (o.output.empty() || o.output == "-") {
    write(o, size, std::cout, "standard output");
    return 0;
  }
  RunFiles files;
  files.write("--output", o.output);
  check_is_nff(o.output);
  write_atomically(o.output, [&](const std::filesystem::path& file) {
    std::ofstream out(file, std::ios::binary);
    write(o, size, out, o.output);
  });
  return 0;
}

}  // namespace

Command add_generate(CLI::App& kdray) {
  CLI::App* const app = kdray.add_subcommand("generate", "Write one of Haines' SPD scenes as an NFF file");
  const auto o = std::make_shared<GenerateArgs>();
  app->add_option("NAME", o->name, "Which scene")->required()->type_name(names());
  add_int(*app, "--size", "Size factor (default: the scene's own, see below)", 0, kSizeMax, o->size);
  add_path(*app, "-o,--output", "The file, .nff (default, and '-': standard output)", o->output);
  app->footer(what_there_is());
  return {app, [o] { return run(*o); }};
}

}  // namespace kdray::cli
