#pragma once
/// Ctrl-C, SIGTERM and SIGHUP set `interrupted`, which long loops look at. A run that has not ended in less than a second is ended as its file
/// stands, with status 130; a second signal ends it at once.

namespace whirl::studies {

void catch_interrupts_of_run(bool quiet);  ///< quiet: without a line that names the result
void end_begins();                         ///< the run writes its end: it is waited for

}  // namespace whirl::studies
