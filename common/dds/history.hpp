/// What writers keep for late joiners, by profile.
#pragma once

#include <cstddef>

#include "dds/types.hpp"

namespace baton::dds {

/// The number of its latest samples that a writer gives to a reader that comes later; 0 for none.
[[nodiscard]] std::size_t latchedDepth(Profile profile);

}  // namespace baton::dds
