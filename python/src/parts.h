// What    The parts of kdray._core, each in a file of its own.
#pragma once

#include <nanobind/nanobind.h>

#include <string>

#include "kdray/kdray.h"

namespace kdray::python {

using SceneClass = nanobind::class_<Scene>;

Look look_of(const std::string& name);  // throws ErrorCode::usage

SceneClass add_scene(nanobind::module_& module);
void add_textures(SceneClass& scene);
void add_queries(SceneClass scene);
void add_pictures(nanobind::module_& module, SceneClass scene);
void add_devices(nanobind::module_& module);
void add_page(nanobind::module_& module);

}  // namespace kdray::python
