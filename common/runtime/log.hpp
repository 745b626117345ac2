/// Logging, set up once a process: lines for a person at three in the morning, on standard error.
#pragma once

#include <string>

namespace baton {

/// Lines look like "03:15:12.345678 warning plant: step=1200 ...". The DDS product's own log goes the same way.
void setUpLog(const std::string& name);

}  // namespace baton
