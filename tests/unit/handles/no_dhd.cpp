// A library that opens and is none of Force Dimension's.
extern "C" int dhdClose(char /*id*/) { return 0; }
