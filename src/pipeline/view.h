// What `selvage view` draws.
#pragma once

#include <span>
#include <string>

#include "pipeline/job.h"
#include "view/picture.h"

namespace selvage::pipeline {

// As the command line has them, of these yarns (all of the input, also where only some are shown).
view::PictureOptions picture_options(Job& job, std::span<const yarn::Body> bodies);
// A picture as a PNG file: of the options' size, with a scale bar unless the command line wants none.
Result<std::string> draw(const Job& job, std::span<const yarn::Body> bodies,
                         const view::PictureOptions& options);

// Is it, or what it is a part of, among --yarns? All are where there is no such option.
bool is_shown(const Options& options, const yarn::BodyLabel& yarn);
bool is_shown(const Options& options, const std::string& name, const std::string& group = {});
// What to say where none is.
Message none_shown(const Options& options);

}  // namespace selvage::pipeline
