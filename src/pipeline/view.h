// What `selvage view` draws.
#pragma once

#include "pipeline/job.h"
#include "view/picture.h"

namespace selvage::pipeline {

// As the command line has them.
view::PictureOptions picture_options(Job& job);

}  // namespace selvage::pipeline
