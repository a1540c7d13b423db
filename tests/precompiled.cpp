// A precompiled header belongs to a program: to this one, which does nothing.
int main() {
  return 0;
}
