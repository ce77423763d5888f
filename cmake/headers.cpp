// Nothing: carries the precompiled headers that other targets share.
