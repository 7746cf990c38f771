/* Wine 8 lacks this library, of which Rust's standard library takes random bytes. For tests under Wine only. */
unsigned char __stdcall SystemFunction036(void *bytes, unsigned long count);
int __stdcall ProcessPrng(unsigned char *bytes, unsigned long long count) { return SystemFunction036(bytes, count); }
