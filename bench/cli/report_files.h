// What    What every `kdray bench` command does: scenes as arguments, tables to stderr, a folder for figures
//         and a plot.
// Errors  ErrorCode::input for a folder that can't be made or written, before anything is measured.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>
#include <vector>

#include "bench/measure/json.h"
#include "bench/plot/plot.h"

namespace kdray::cli {

void add_report(CLI::App& app, std::string& report);
void add_scenes(CLI::App& app, std::vector<std::string>& scenes, const std::string& default_scenes);

// Throws for a name that is neither a file's nor a built-in scene's: before the first scene is measured.
void require_scenes(const std::vector<std::string>& scenes);

// A folder for the report, made before anything is measured; nothing where there is to be none.
void prepare_report(const std::string& folder, const std::string& name);
void write_report(const std::string& folder, const std::string& name, const bench::Json& json,
                  const std::string& svg);
void write_report(const std::string& folder, const std::string& name, const bench::Json& json,
                  const bench::Plot& plot);

void print_table(const std::string& table);
void say_without_embree();

}  // namespace kdray::cli
