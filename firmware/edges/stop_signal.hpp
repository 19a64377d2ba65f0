// SIGTERM and SIGINT as a question: has anyone asked this program to stop? And SIGHUP: to reload?
#pragma once

namespace rfmvo {

// SIGPIPE is ignored. From now on both signals only set the flag; system calls that wait return early. A second signal
// ends the program at once.
void catch_stop_signals();
[[nodiscard]] bool stop_requested();

// SIGHUP: true once after each. Only for programs that reload something.
void catch_reload_signal();
[[nodiscard]] bool take_reload_request();
void request_reload();  // as if SIGHUP had come

}  // namespace rfmvo
