// What    That all processes which share a sequence, and all runs that go on from it, make the same frames: a
//         frame that is done is not looked at again, so that its own checkpoint can't tell.
// Shape   DIR/sequence.ledger, made once, has what was asked for and has a say in the pictures, a line for
//         each. The scene itself is checked by the checkpoint of each frame that is rendered.
// Errors  ErrorCode::input, in a line that says which setting differs.
#pragma once

#include <filesystem>

#include "apps/cli/render_frame.h"

namespace kdray::cli {

void check_sequence_settings(const RenderArgs& o, const std::filesystem::path& folder);

}  // namespace kdray::cli
