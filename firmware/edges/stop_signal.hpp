// SIGTERM and SIGINT as a question: has anyone asked this program to stop?
#pragma once

namespace rfmvo {

// SIGPIPE is ignored. From now on both signals only set the flag; system calls that wait return early. A second signal
// ends the program at once.
void catch_stop_signals();
[[nodiscard]] bool stop_requested();

}  // namespace rfmvo
