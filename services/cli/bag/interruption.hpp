/// Ctrl-C and other signals that ask for the end, while a command makes files.
#pragma once

namespace baton {

/// From here on they end the program at once with kInterrupted, and nobody finds a file that is not finished.
void removeUnfinishedOnSignals();

}  // namespace baton
