// The common headers, and what nearly every file here has beside them; compiled once.
#pragma once

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "core/precompiled.h"
