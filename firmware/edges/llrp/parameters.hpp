// All parameters of messages.hpp, as a list of types. Within the codec only.
#pragma once

#include "edges/llrp/messages.hpp"

namespace rfmvo::llrp {

template <class... T>
struct TypeList {};

using Parameters = TypeList<
    Custom, FieldError, ParameterError, LLRPStatus, ReceiveSensitivityTableEntry, PerAntennaReceiveSensitivityRange,
    PerAntennaAirProtocol, GPIOCapabilities, GeneralDeviceCapabilities, LLRPCapabilities, TransmitPowerLevelTableEntry,
    FrequencyHopTable, FixedFrequencyTable, FrequencyInformation, C1G2UHFRFModeTableEntry, C1G2UHFRFModeTable,
    UHFBandCapabilities, RegulatoryCapabilities, C1G2LLRPCapabilities, RFReceiver, RFTransmitter, C1G2TagInventoryMask,
    C1G2TagInventoryStateAwareFilterAction, C1G2TagInventoryStateUnawareFilterAction, C1G2Filter, C1G2RFControl,
    C1G2TagInventoryStateAwareSingulationAction, C1G2SingulationControl, C1G2InventoryCommand, AntennaConfiguration,
    InventoryParameterSpec, UTCTimestamp, Uptime, PeriodicTriggerValue, GPITriggerValue, ROSpecStartTrigger,
    ROSpecStopTrigger, ROBoundarySpec, TagObservationTrigger, AISpecStopTrigger, AISpec, RFSurveySpecStopTrigger,
    RFSurveySpec, C1G2EPCMemorySelector, TagReportContentSelector, ROReportSpec, ROSpec, LLRPConfigurationStateValue,
    Identification, GPOWriteData, KeepaliveSpec, AntennaProperties, GPIPortCurrentState, EventsAndReports,
    AccessReportSpec, EventNotificationState, ReaderEventNotificationSpec, EPCData, EPC_96, ROSpecID, SpecIndex,
    InventoryParameterSpecID, AntennaID, PeakRSSI, ChannelIndex, FirstSeenTimestampUTC, FirstSeenTimestampUptime,
    LastSeenTimestampUTC, LastSeenTimestampUptime, TagSeenCount, C1G2_PC, C1G2_CRC, AccessSpecID, C1G2ReadOpSpecResult,
    C1G2WriteOpSpecResult, C1G2KillOpSpecResult, C1G2LockOpSpecResult, C1G2BlockEraseOpSpecResult,
    C1G2BlockWriteOpSpecResult, TagReportData, FrequencyRSSILevelEntry, RFSurveyReportData, HoppingEvent, GPIEvent,
    ROSpecEvent, ReportBufferLevelWarningEvent, ReportBufferOverflowErrorEvent, OpSpecID, ReaderExceptionEvent,
    RFSurveyEvent, C1G2SingulationDetails, AISpecEvent, AntennaEvent, ConnectionAttemptEvent, ConnectionCloseEvent,
    ReaderEventNotificationData>;

}  // namespace rfmvo::llrp
