MODULE Watch
  VAR intnum iPulse;

  PROC main()
    VAR robtarget pStart;
    CONNECT iPulse WITH tCount;
    ISignalDI diPulse, 1, iPulse;
    pStart := CRobT();
    MoveL Offs(pStart,0,0,nHeight), v200, fine, tool0;
    IF pulses >= 2 THEN
      Set doGrip;
    ENDIF
    IDelete iPulse;
    WaitTime 0.3;
    lower nHeight/2;
  ENDPROC

  TRAP tCount
    pulses := pulses + 1;
  ENDTRAP
ENDMODULE
