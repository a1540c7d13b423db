// What nearly every file of the tests uses; compiled once.
#pragma once

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "core/precompiled.h"
