// Nothing: carries the precompiled headers that all tests share.
