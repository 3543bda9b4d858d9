// What    What every `kdray bench` command does: scenes as arguments, tables to stderr, a folder for figures
//         and their plot, which the script kdray-bench-plot beside the program draws (bench/plot).
// Errors  ErrorCode::input for a folder that can't be made or written, before anything is measured.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>
#include <vector>

#include "bench/measure/json.h"

namespace kdray::cli {

void add_report(CLI::App& app, std::string& report);
void add_scenes(CLI::App& app, std::vector<std::string>& scenes, const std::string& default_scenes);

// Throws for a name that is neither a file's nor a built-in scene's: before the first scene is measured.
void require_scenes(const std::vector<std::string>& scenes);

// A folder for the report, made before anything is measured; nothing where there is to be none.
void prepare_report(const std::string& folder, const std::string& name);
// Where no plot can be drawn, a line says why; the figures are there all the same.
void write_report(const std::string& folder, const std::string& name, const bench::Json& json);

void print_table(const std::string& table);
void say_without_embree();

}  // namespace kdray::cli
