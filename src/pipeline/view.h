// What `selvage view` draws.
#pragma once

#include "pipeline/job.h"
#include "view/picture.h"

namespace selvage::pipeline {

// As the command line has them.
view::PictureOptions picture_options(Job& job);

// Is it, or what it is a part of, among --yarns? All are where there is no such option.
bool is_shown(const Options& options, const yarn::BodyLabel& yarn);
// What to say where none is.
Message none_shown(const Options& options);

}  // namespace selvage::pipeline
