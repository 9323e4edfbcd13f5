// Only the depth changes of a pixel that was buried.

void main() {}
