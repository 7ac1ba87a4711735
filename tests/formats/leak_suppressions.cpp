// Read by LeakSanitizer where it is built in: fontconfig keeps its font tables until the process ends.
extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions() { return "leak:libfontconfig"; }
