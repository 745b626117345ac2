/// What other people's DDS systems leave in a user's environment.
#pragma once

namespace baton::dds {

/// The DDS product takes servers, transports and profiles from environment variables and from a file in the working
/// directory, over everything a program asks for: processes of one run would then not find each other. Takes these
/// variables out of this process's environment, and with that out of its children's, so that Baton's discovery is the
/// same everywhere. Every process does so before its first participant; not to be called when other threads may look
/// at the environment.
void ignoreForeignSettings();

}  // namespace baton::dds
