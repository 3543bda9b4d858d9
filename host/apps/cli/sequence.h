// What    --frames: the frames of a sequence, by a camera path, from numbered scenes or of an animation, to
//         numbered pictures; alone one after the other, with --share each by a process that is free.
// Shape   A shared sequence has a lease for each frame: a process takes one that nobody has; when there is
//         none left it joins the others in theirs, tile by tile. Each frame has its own checkpoint, in
//         DIR/frame-N.
// Errors  kdray::Error, ErrorCode::usage: what makes no sequence.
#pragma once

#include <string>

#include "apps/cli/render_frame.h"

namespace kdray::cli {

// Throws where options don't go together; called before anything else is done.
void check_checkpoint(const RenderArgs& o);

int render_sequence(const RenderArgs& o);

// Returns "out%04d.png" with the number in it. A name without such a place gets the number, in four digits,
// before its ending where `insert`, and stays as it is otherwise.
std::string numbered(const std::string& name, int number, bool insert);

}  // namespace kdray::cli
